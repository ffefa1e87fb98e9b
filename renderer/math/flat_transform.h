// Maps that flatten space, as a scale of zero does. They have no inverse: the zero matrix stands in its
// place, also in that of their products with other maps.
#pragma once

#include "renderer/math/transform.h"

namespace tessera {

inline Matrix4 ZeroMatrix() {
  Matrix4 zero;
  for (auto& row : zero.m) row.fill(0);
  return zero;
}

inline bool IsFlat(const Transform& transform) {
  return transform.inverse_matrix() == ZeroMatrix();
}

// The map of a matrix: flat if the matrix has no inverse in the range of float.
inline Transform MapOf(const Matrix4& matrix) {
  const std::optional<Matrix4> inverse = Inverse(matrix);
  return {matrix, inverse ? *inverse : ZeroMatrix()};
}

// The map with the inverse of its very matrix, unless it is flat. The matrix and the inverse of a product are
// rounded apart: where large translations cancel, the one no longer undoes the other.
inline Transform WithExactInverse(const Transform& transform) {
  if (IsFlat(transform)) return transform;
  const std::optional<Matrix4> inverse = Inverse(transform.matrix());
  return inverse ? Transform(transform.matrix(), *inverse) : transform;
}

}  // namespace tessera
