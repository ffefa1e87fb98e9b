// A scene file made ready to be rendered here or sent to a farm.
#pragma once

#include <memory>
#include <string>

#include "client/options.h"
#include "farm/packed_scene.h"
#include "scene/scene.h"

namespace tessera {

// Immutable once loaded.
struct SceneJob {
  std::unique_ptr<Scene> scene;
  PackedScene packed;
};

// Reads the scene with all its files and says on stderr what it asks for and will not get. The same scene
// gives the same `frame` at either depth: nothing in a picture tells how it was rendered.
Result<SceneJob> LoadSceneJob(const Options& options, Scene::Depth depth);

}  // namespace tessera
