// Sampling of one bilinear patch of a mesh.
#pragma once

#include "renderer/shape/patch.h"
#include "renderer/shape/shape_sampling.h"

namespace tessera {

// Rectangles by solid angle, weighted by the cosine at the reference point's surface; other patches, and
// rectangles that cover too little of the sphere, by area.
std::optional<ShapeSample> SamplePatch(const BilinearMesh& mesh, uint32_t primitive,
                                       const ReferencePoint& reference, Point2 u);
float PatchPdf(const BilinearMesh& mesh, uint32_t primitive, const ReferencePoint& reference,
               const SurfaceInteraction& on_light);

float PatchArea(const PatchPoints& patch);
NormalCone PatchNormals(const BilinearMesh& mesh, uint32_t primitive);

// The parameters of a point on the patch, by Gauss-Newton iteration.
Point2 InvertPatch(const PatchPoints& patch, Point3 p);

}  // namespace tessera
