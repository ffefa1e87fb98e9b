// A scene, or the frames of a sequence, as sent to a farm.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "proto/scene_package.h"
#include "proto/terms.h"

namespace tessera {

struct PackedScene {
  std::vector<FrameRequest> frames;  // with the attributes of the picture files
  ScenePackage package;
  std::string manifest;                      // EncodeScenePackage(package)
  Digest digest;                             // of the manifest
  std::map<Digest, std::string> disk_paths;  // of each file of the package that is on disk
  std::map<Digest, std::shared_ptr<const std::string>> in_memory;  // the others
};

}  // namespace tessera
