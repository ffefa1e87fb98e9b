// One triangle: where a ray meets it and what its plane is like.
#pragma once

#include "renderer/shape/double3.h"

namespace tessera {

struct TrianglePoints {
  Point3 p0, p1, p2;
};

// Distance and barycentric coordinates of the point where a ray meets the triangle's plane.
struct TriangleCrossing {
  double t = 0;
  double u = 0, v = 0;  // of vertices 1 and 2
};
// In double (Moeller and Trumbore 1997). False if the ray is parallel to the plane or the triangle has no
// area.
bool CrossTriangle(const TrianglePoints& triangle, const DoubleRay& ray, TriangleCrossing* crossing);

// Unit normal of the vertices' winding, not flipped. Never NaN: (0, 0, 1) if the triangle has no area.
Normal3 TriangleWindingNormal(const TrianglePoints& triangle);
// The same for triangles whose area float cannot hold.
Normal3 NormalOfExtremeTriangle(const TrianglePoints& triangle);

Point3 TrianglePoint(const TrianglePoints& triangle, float u, float v);
// Half size of a box around TrianglePoint(u, v) such that rays that start outside are also *found* to start
// outside: it covers the rounding of the point and that of single-precision intersection tests against the
// whole triangle.
Vec3 TrianglePointError(const TrianglePoints& triangle, float u, float v);

float TriangleArea(const TrianglePoints& triangle);

}  // namespace tessera
