// Interpolation between two transforms, for what moves.
#pragma once

#include <array>
#include <optional>

#include "renderer/math/transform.h"

namespace tessera {

// The way from one map to another, prepared for use at many places: translation and stretch go straight, the
// rotation turns at constant speed along the shortest way (Shoemake and Duff 1992, "Matrix Animation and
// Polar Decomposition", as pbrt does). If one of the maps is flat, all elements of the matrix go straight:
// what grows from nothing or shrinks to it has no rotation there. Immutable.
class TransformPath {
 public:
  // Both must be affine.
  TransformPath(const Transform& start, const Transform& end);

  // The map at fraction `s` in [0, 1] of the way: exactly `start` at 0 and `end` at 1. Returns nullopt if the
  // map between is singular, as on the way from a map to its mirror image.
  std::optional<Transform> At(float s) const;

  // A box around all that the maps at fractions `from` to `to` make of the points of `box`.
  Bounds3 BoundsOf(const Bounds3& box, float from, float to) const;

 private:
  using Matrix3 = std::array<std::array<double, 3>, 3>;
  // w + xi + yj + zk
  struct Quaternion {
    double w = 1, x = 0, y = 0, z = 0;
  };
  // Translation after rotation after stretch.
  struct Parts {
    double translation[3];
    Quaternion rotation;
    Matrix3 stretch;
  };

  static Quaternion FromRotation(const Matrix3& m);
  static Matrix3 ToRotation(const Quaternion& q);
  static Parts Decompose(const Transform& transform);
  Quaternion RotationAt(float s) const;
  Matrix4 MatrixAt(float s) const;
  // A bound of the second derivative of a point of `box` by the fraction.
  double AccelerationMax(const Bounds3& box) const;

  Transform start_, end_;
  bool is_straight_ = false;  // element by element
  Parts from_{}, to_{};
  float cosine_ = 1, angle_ = 0;  // between the quaternions: half the angle of the rotation
};

// One map of a path.
std::optional<Transform> Interpolate(const Transform& start, const Transform& end, float s);

}  // namespace tessera
