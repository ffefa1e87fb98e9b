// Ray against sphere, cylinder or disk.
#pragma once

#include "renderer/shape/quadric.h"

namespace tessera {

// The nearest t in (0, t_max] at which a ray, given in the space that the quadric's transform leads to, meets
// it. In double precision: rays that start outside the box SurfaceInteraction::p_error do not find the
// surface they left.
bool IntersectQuadric(const Quadric& quadric, const DoubleRay& ray, double t_max, double* t);

}  // namespace tessera
