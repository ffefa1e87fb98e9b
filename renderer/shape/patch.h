// One bilinear patch of a mesh: p(u, v) between four corners, and what the surface is like there.
#pragma once

#include "renderer/shape/double3.h"
#include "renderer/shape/geometry.h"
#include "renderer/shape/interaction.h"

namespace tessera {

struct PatchPoints {
  Point3 p00, p10, p01, p11;
};
inline PatchPoints PatchAt(const BilinearMesh& mesh, uint32_t primitive) {
  const uint32_t* v = &mesh.indices[4 * size_t{primitive}];
  return {mesh.P[v[0]], mesh.P[v[1]], mesh.P[v[2]], mesh.P[v[3]]};
}

Point3 PatchPoint(const PatchPoints& patch, Point2 uv);
Vec3 PatchPointError(const PatchPoints& patch);
struct PatchDerivatives {
  Vec3 dpdu, dpdv;
};
PatchDerivatives DifferentiatePatch(const PatchPoints& patch, Point2 uv);
// dp/du x dp/dv, whose length is the area per (u, v) area.
Vec3 PatchCross(const PatchPoints& patch, Point2 uv);

// Whether the patch is a plane parallelogram: the fourth corner is where the other three put it, within
// kParallelogramTolerance of the largest coordinate. The error of taking it for one is within
// PatchPointError.
constexpr float kParallelogramTolerance = 1e-6f;
bool IsParallelogram(const PatchPoints& patch);
// Whether it is a plane rectangle, by pbrt's tolerances.
bool IsRectangle(const PatchPoints& patch);

// From patch parameters to texture coordinates: the mesh's, or the parameters themselves.
Point2 PatchTextureCoordinates(const BilinearMesh& mesh, uint32_t primitive, Point2 uv);
// The geometric normal at (u, v): on the side of the interpolated normal if the mesh has normals, else as
// flip_normals says.
Normal3 PatchNormal(const BilinearMesh& mesh, uint32_t primitive, const PatchPoints& patch, Point2 uv);

// Position, normals and derivatives at patch parameters uv; surface properties, wo and time are left alone.
void FillPatchInteraction(const BilinearMesh& mesh, uint32_t primitive, Point2 uv,
                          SurfaceInteraction* interaction);

}  // namespace tessera
