// The Option directives of a scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "renderer/description/scene_description.h"

namespace tessera {

struct SceneOptions {
  uint64_t seed = 0;
  bool wavefront = false;
};

// Options that we do not have are warnings, values that make no sense are errors.
Result<SceneOptions> ReadSceneOptions(const SceneDescription& scene, Diagnostics& diagnostics);

// The accelerator to use: what the command line names, else "embree". Scenes name structures of pbrt's own,
// which do not change the picture: their names are checked and nothing more.
Result<std::string> ChooseAccelerator(const Entity& entity, const std::string& option);

}  // namespace tessera
