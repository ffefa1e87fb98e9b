// One triangle of a mesh: where a ray meets it and what the surface is like there.
#pragma once

#include "renderer/shape/double3.h"
#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"

namespace tessera {

struct TrianglePoints {
  Point3 p0, p1, p2;
};
inline TrianglePoints TriangleAt(const TriangleMesh& mesh, uint32_t primitive) {
  const uint32_t* v = &mesh.indices[3 * size_t{primitive}];
  return {mesh.P[v[0]], mesh.P[v[1]], mesh.P[v[2]]};
}

// Texture coordinates of the three corners; (0,0) (1,0) (1,1) if the mesh has none.
struct TriangleUv {
  Point2 uv0{0, 0}, uv1{1, 0}, uv2{1, 1};
};
TriangleUv TriangleUvAt(const TriangleMesh& mesh, uint32_t primitive);

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
// The geometric normal at barycentrics (u, v): on the side of the interpolated normal if the mesh has
// normals, else as flip_normals says.
Normal3 TriangleNormal(const TriangleMesh& mesh, uint32_t primitive, const TrianglePoints& triangle, float u,
                       float v);

Point3 TrianglePoint(const TrianglePoints& triangle, float u, float v);
Point2 TriangleTextureCoordinates(const TriangleMesh& mesh, uint32_t primitive, float u, float v);

// Half size of a box around TrianglePoint(u, v) such that rays that start outside are also *found* to start
// outside: it covers the rounding of the point and that of single-precision intersection tests against the
// whole triangle.
Vec3 TrianglePointError(const TrianglePoints& triangle, float u, float v);

// Position, normals and derivatives; surface properties, wo and time are left alone.
void FillTriangleInteraction(const TriangleMesh& mesh, uint32_t primitive, float u, float v,
                             SurfaceInteraction* interaction);

}  // namespace tessera
