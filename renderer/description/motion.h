// What moves in a scene.
#pragma once

#include "renderer/description/scene_description.h"
#include "renderer/util/result.h"

namespace tessera {

// Checks the transforms that move, which must be affine; that of the camera must have an inverse at all
// times. Returns how many there are, of the camera, shapes, instances and lights, or the first error with its
// place.
Result<int> CheckMotion(const SceneDescription& scene);

// Makes `time_s` the time 0 of all that moves.
void StartTimeAt(double time_s, SceneDescription& scene);

// Fixes all transforms that move at their values at `time_s`. The camera must have an inverse then.
Result<void> StopMotion(double time_s, SceneDescription& scene);

}  // namespace tessera
