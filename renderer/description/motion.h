// Shows what moves in a scene at one moment.
#pragma once

#include <optional>

#include "renderer/description/scene_description.h"
#include "renderer/util/result.h"

namespace tessera {

// Fixes the transforms of the camera, the shapes and the instances that move at their values at `time_s`, or
// in the middle of the camera's shutter if there is no time. Returns how many moved. A transform that is
// singular at that time is an error with its place.
Result<int> StopMotion(std::optional<double> time_s, SceneDescription& scene);

}  // namespace tessera
