// Sampling of one triangle of a mesh.
#pragma once

#include "renderer/shape/shape_sampling.h"
#include "renderer/shape/triangle.h"

namespace tessera {

// By solid angle, weighted by the cosine at the reference point's surface; by area where the triangle covers
// too little or too much of the sphere for that to be accurate (Pharr, Jakob, Humphreys 2023, section 6.5.4).
std::optional<ShapeSample> SampleTriangle(const TriangleMesh& mesh, uint32_t primitive,
                                          const ReferencePoint& reference, Point2 u);
float TrianglePdf(const TriangleMesh& mesh, uint32_t primitive, const ReferencePoint& reference, Vec3 wi,
                  const SurfaceInteraction& on_light);

float TriangleArea(const TrianglePoints& triangle);
NormalCone TriangleNormals(const TriangleMesh& mesh, uint32_t primitive);

}  // namespace tessera
