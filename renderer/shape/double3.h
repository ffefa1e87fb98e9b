// Three doubles, for the few places where a float's 24 bits do not suffice: intersections whose result must
// not depend on the machine that computes them. Only + - * / and sqrt, which are the same on every machine.
#pragma once

#include <cmath>

#include "renderer/math/transform.h"
#include "renderer/math/vec.h"

namespace tessera {

struct Double3 {
  double x = 0, y = 0, z = 0;

  Double3() = default;
  Double3(double a, double b, double c) : x(a), y(b), z(c) {}
  explicit Double3(Vec3 v) : x(v.x), y(v.y), z(v.z) {}
  Vec3 ToFloat() const { return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)}; }
};

inline Double3 operator+(Double3 a, Double3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Double3 operator-(Double3 a, Double3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Double3 operator*(Double3 a, double s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline double Dot(Double3 a, Double3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Double3 Cross(Double3 a, Double3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Double3 Lerp(double t, Double3 a, Double3 b) {
  return a * (1 - t) + b * t;
}
// The difference of two points given in float: exact except for the last rounding.
inline Double3 Difference(Vec3 a, Vec3 b) {
  return Double3(a) - Double3(b);
}

// By an affine matrix.
inline Double3 TransformPoint(const Matrix4& matrix, Double3 p) {
  const auto& m = matrix.m;
  return {m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3],
          m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3],
          m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3]};
}
inline Double3 TransformVector(const Matrix4& matrix, Double3 v) {
  const auto& m = matrix.m;
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

// A ray in double. t means the same before and after a transform, since d is not normalised.
struct DoubleRay {
  Double3 o, d;

  Double3 At(double t) const { return o + d * t; }
  DoubleRay TransformedBy(const Matrix4& m) const { return {TransformPoint(m, o), TransformVector(m, d)}; }
};

}  // namespace tessera
