// A scene file made ready to be rendered here or sent to a farm.
#pragma once

#include <memory>
#include <string>

#include "client/options.h"
#include "scene/scene.h"
#include "terms/scene_package.h"
#include "terms/terms.h"

namespace tessera {

// Immutable once loaded.
struct SceneJob {
  std::unique_ptr<Scene> scene;
  FrameOrder frame;  // with the attributes that the picture's file will have
  ScenePackage package;
  std::string manifest;                      // EncodeScenePackage(package)
  Digest digest;                             // of the manifest
  std::map<Digest, std::string> disk_paths;  // where each file of the package is
};

// Reads the scene with all its files and says on stderr what it asks for and will not get. The same scene
// gives the same `frame` at either depth: nothing in a picture tells how it was rendered.
Result<SceneJob> LoadSceneJob(const Options& options, Scene::Depth depth);

}  // namespace tessera
