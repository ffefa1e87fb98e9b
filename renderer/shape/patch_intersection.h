// Ray against bilinear patch.
#pragma once

#include "renderer/shape/patch.h"
#include "renderer/shape/shape_queries.h"

namespace tessera {

// The nearest crossing with t in (0, t_max] (Reshetov 2019, "Cool patches", in double precision).
bool IntersectPatch(const PatchPoints& patch, const DoubleRay& ray, double t_max, Crossing* crossing);

// Where the ray's line meets a patch that is known to be a parallelogram and to be hit: u and v are clamped
// to [0, 1]. False if the ray lies in its plane.
bool CrossParallelogram(const PatchPoints& patch, const DoubleRay& ray, Crossing* crossing);

}  // namespace tessera
