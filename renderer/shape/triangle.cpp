#include "renderer/shape/triangle.h"

#include <cmath>

#include "renderer/shape/packed_triangle.h"

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
  return PackedTriangle(triangle).WindingNormal().Unpack();
}

Normal3 NormalOfExtremeTriangle(const TrianglePoints& triangle) {
  const Double3 exact = Cross(Difference(triangle.p0, triangle.p2), Difference(triangle.p1, triangle.p2));
  const double length = std::sqrt(Dot(exact, exact));
  return length > 0 ? (exact * (1 / length)).ToFloat() : Normal3{0, 0, 1};
}

Point3 TrianglePoint(const TrianglePoints& triangle, float u, float v) {
  return PackedTriangle(triangle).PointAt(u, v).Unpack();
}

Vec3 TrianglePointError(const TrianglePoints& triangle, float u, float v) {
  return PackedTriangle(triangle).PointErrorAt(u, v).Unpack();
}

float TriangleArea(const TrianglePoints& triangle) {
  return 0.5f * Length(Cross(triangle.p1 - triangle.p0, triangle.p2 - triangle.p0));
}

}  // namespace tessera
