// 3 x 3 matrices that act on column vectors: maps between colour components.
#pragma once

#include <array>

#include "renderer/math/vec.h"

namespace tessera {

using Matrix3 = std::array<std::array<float, 3>, 3>;  // [row][column]

inline Matrix3 Multiply(const Matrix3& a, const Matrix3& b) {
  Matrix3 r{};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) r[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  }
  return r;
}

inline Vec3 Multiply(const Matrix3& m, Vec3 v) {
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

}  // namespace tessera
