// Interpolation between two transforms, for what moves.
#pragma once

#include <optional>

#include "renderer/math/transform.h"

namespace tessera {

// The map at fraction `s` in [0, 1] of the way from `start` to `end`: translation and stretch go straight,
// the rotation turns at constant speed along the shortest way (Shoemake and Duff 1992, "Matrix Animation and
// Polar Decomposition", as pbrt does). Exactly `start` at 0 and `end` at 1. Returns nullopt if the map
// between is singular, as on the way from a map to its mirror image. Both must be affine.
std::optional<Transform> Interpolate(const Transform& start, const Transform& end, float s);

}  // namespace tessera
