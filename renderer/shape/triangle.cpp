#include "renderer/shape/triangle.h"

#include <cmath>

#include "renderer/shape/packed_triangle.h"

namespace tessera {

bool CrossTriangle(const TrianglePoints& triangle, const DoubleRay& ray, TriangleCrossing* crossing) {
  return PackedTriangle(triangle).Cross(PackedDoubleRay(ray), crossing);
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
