// Affine and projective maps of space.
#pragma once

#include <array>
#include <optional>

#include "renderer/math/bounds.h"
#include "renderer/math/vec.h"

namespace tessera {

// A 4x4 matrix m[row][column] that acts on column vectors.
struct Matrix4 {
  std::array<std::array<float, 4>, 4> m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
  bool operator==(const Matrix4&) const = default;
};

Matrix4 operator*(const Matrix4& a, const Matrix4& b);
Matrix4 Transpose(const Matrix4& a);
// Returns nullopt if the matrix is singular.
std::optional<Matrix4> Inverse(const Matrix4& a);
// The same of an affine matrix, in a fraction of the time; not always with the same bits.
std::optional<Matrix4> AffineInverse(const Matrix4& a);
float Determinant(const Matrix4& a);

// A matrix with its inverse.
class Transform {
 public:
  Transform() = default;
  // `inverse` must be the inverse of `matrix`.
  Transform(const Matrix4& matrix, const Matrix4& inverse) : m_(matrix), inverse_(inverse) {}
  // Returns nullopt if the matrix is singular or not finite.
  static std::optional<Transform> FromMatrix(const Matrix4& matrix);

  const Matrix4& matrix() const { return m_; }
  const Matrix4& inverse_matrix() const { return inverse_; }
  Transform Inverse() const { return {inverse_, m_}; }
  bool operator==(const Transform&) const = default;
  // Whether the map turns right-handed frames into left-handed ones.
  bool SwapsHandedness() const;
  bool IsIdentity() const { return m_ == Matrix4{}; }
  // Whether the map keeps angles, up to rounding: rotations and mirror images with one scale for all axes.
  bool KeepsAngles() const;

  // A point; divides by w if the last row is not (0 0 0 1).
  Point3 ToPoint(Point3 p) const;
  Vec3 ToVector(Vec3 v) const;
  // By the inverse transpose; not normalised.
  Normal3 ToNormal(Normal3 n) const;
  Bounds3 ToBounds(const Bounds3& b) const;

 private:
  Matrix4 m_, inverse_;
};

// a after b.
Transform operator*(const Transform& a, const Transform& b);

Transform Translate(Vec3 delta);
// Factors must not be zero.
Transform Scale(float x, float y, float z);
// By `degrees` about `axis`, which must not be zero.
Transform Rotate(float degrees, Vec3 axis);
// World to camera: +x right, +y up, +z forward, left-handed as in pbrt. Returns nullopt if `up` is
// parallel to the view or the points coincide.
std::optional<Transform> LookAt(Point3 eye, Point3 look, Vec3 up);
// Projection onto z = 1 with z mapped from [near, far] to [0, 1].
Transform Perspective(float fov_degrees, float near, float far);

}  // namespace tessera
