// A scene as it is sent to a farm.
#pragma once

#include <map>
#include <string>

#include "terms/scene_package.h"
#include "terms/terms.h"

namespace tessera {

struct PackedScene {
  FrameOrder frame;  // with the attributes that the picture's file will have
  ScenePackage package;
  std::string manifest;                      // EncodeScenePackage(package)
  Digest digest;                             // of the manifest
  std::map<Digest, std::string> disk_paths;  // where each file of the package is
};

}  // namespace tessera
