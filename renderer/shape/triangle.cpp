#include "renderer/shape/triangle.h"

#include <cmath>

#include "renderer/math/ray.h"

namespace tessera {

bool CrossTriangle(const TrianglePoints& triangle, const DoubleRay& ray, TriangleCrossing* crossing) {
  const Double3 e1 = Difference(triangle.p1, triangle.p0);
  const Double3 e2 = Difference(triangle.p2, triangle.p0);
  const Double3 p = Cross(ray.d, e2);
  const double determinant = Dot(e1, p);
  if (determinant == 0) return false;
  const double inverse = 1 / determinant;
  const Double3 s = ray.o - Double3(triangle.p0);
  const Double3 q = Cross(s, e1);
  crossing->t = Dot(e2, q) * inverse;
  crossing->u = Dot(s, p) * inverse;
  crossing->v = Dot(ray.d, q) * inverse;
  return true;
}

Normal3 TriangleWindingNormal(const TrianglePoints& triangle) {
  const Vec3 n = Cross(triangle.p0 - triangle.p2, triangle.p1 - triangle.p2);
  const float length_squared = LengthSquared(n);
  constexpr float kSafe = 1e-30f;  // no underflow in the squares
  if (length_squared > kSafe && length_squared < std::numeric_limits<float>::infinity()) {
    return n / std::sqrt(length_squared);
  }
  const Double3 exact = Cross(Difference(triangle.p0, triangle.p2), Difference(triangle.p1, triangle.p2));
  const double length = std::sqrt(Dot(exact, exact));
  return length > 0 ? (exact * (1 / length)).ToFloat() : Normal3{0, 0, 1};
}

// In double: the point lies in the triangle's plane except for the last rounding.
Point3 TrianglePoint(const TrianglePoints& triangle, float u, float v) {
  const Double3 p0(triangle.p0);
  return (p0 + Difference(triangle.p1, triangle.p0) * u + Difference(triangle.p2, triangle.p0) * v).ToFloat();
}

Vec3 TrianglePointError(const TrianglePoints& triangle, float u, float v) {
  const Vec3 sum = Abs(triangle.p0 * (1 - u - v)) + Abs(triangle.p1 * u) + Abs(triangle.p2 * v);
  const Vec3 extent =
      Max(triangle.p0, Max(triangle.p1, triangle.p2)) - Min(triangle.p0, Min(triangle.p1, triangle.p2));
  return sum * Gamma(7) + extent * Gamma(3);
}

float TriangleArea(const TrianglePoints& triangle) {
  return 0.5f * Length(Cross(triangle.p1 - triangle.p0, triangle.p2 - triangle.p0));
}

}  // namespace tessera
