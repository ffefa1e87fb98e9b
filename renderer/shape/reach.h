// What single precision can trace.
#pragma once

#include <array>
#include <cmath>

#include "renderer/math/transform.h"

namespace tessera {

// Of shapes and instances, in rendering space: products of two coordinates stay finite.
constexpr float kCoordinateMax = 1e17f;
// By how much a ray may grow in the space of an instance.
constexpr float kRayGrowthMax = 1e12f;

// Whether an instance is neither too small, too large nor too far away for rays in single precision.
inline bool IsReachable(const Transform& render_from_group) {
  const auto is_within = [](const Matrix4& matrix, float linear_max) {
    for (size_t row = 0; row < 3; ++row) {
      const std::array<float, 4>& m = matrix.m[row];
      if (!(std::abs(m[0]) + std::abs(m[1]) + std::abs(m[2]) <= linear_max)) return false;
      if (!(std::abs(m[3]) <= kCoordinateMax)) return false;
    }
    return true;
  };
  return is_within(render_from_group.matrix(), kCoordinateMax) &&
         is_within(render_from_group.inverse_matrix(), kRayGrowthMax);
}

}  // namespace tessera
