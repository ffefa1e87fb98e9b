// What moves in a scene, at one moment.
#pragma once

#include <optional>

#include "renderer/description/scene_description.h"
#include "renderer/util/result.h"

namespace tessera {

// Puts the camera, the shapes and the instances that move where they are at `time` (seconds, as
// TransformTimes counts them; before the first and after the last time everything rests), so that nothing
// moves any more; without a time, where they are in the middle of the shutter. How many there were. A map
// that is singular at that time is an error with its place. Lights, textures and media stay as they were:
// they do not move (their directives say so).
Result<int> StopMotion(std::optional<double> time, SceneDescription* scene);

}  // namespace tessera
