// The equal-area octahedral map between the unit square and the sphere (Clarberg 2008, "Fast Equal-Area
// Mapping of the (Hemi)Sphere using SIMD"), oriented as environment maps of pbrt-v4 are: the centre of the
// square is +z, its corners are -z. Equal areas of the square are equal solid angles: a density per area of
// the square is 4 pi times the one per solid angle.
#pragma once

#include "renderer/math/vec.h"

namespace tessera {

// p in [0, 1]^2; the result is a unit vector.
Vec3 EqualAreaSquareToSphere(Point2 p);
// The inverse; d is a unit vector.
Point2 EqualAreaSphereToSquare(Vec3 d);

}  // namespace tessera
