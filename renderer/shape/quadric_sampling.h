// Sampling of spheres, cylinders and disks.
#pragma once

#include "renderer/shape/quadric.h"
#include "renderer/shape/shape_sampling.h"

namespace tessera {

// Whole spheres that are not stretched, from outside: uniform over the cone that they fill. Everything else:
// uniform over the area in object space, with the density that this is in rendering space.
std::optional<ShapeSample> SampleQuadric(const Quadric& quadric, const ReferencePoint& reference, Point2 u);
float QuadricPdf(const Quadric& quadric, const ReferencePoint& reference, const SurfaceInteraction& on_light);
// Whether it is a cone that would be sampled: then only the nearest point along each direction is.
bool SamplesByCone(const Quadric& quadric, const ReferencePoint& reference);

// In rendering space; of stretched spheres and cylinders by quadrature.
float QuadricArea(const Quadric& quadric);
NormalCone QuadricNormals(const Quadric& quadric);

}  // namespace tessera
