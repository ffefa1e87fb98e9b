// Gradient noise and what is built from it (Perlin 1985, 2002), band-limited by the footprint. Pure
// functions.
#pragma once

#include "renderer/math/vec.h"

namespace tessera {

// In about [-1, 1], 0 at whole places, smooth between.
float Noise(Point3 p);

// Sum of octaves, each 1.99 times finer and `roughness` times weaker than the one before; those finer than
// the footprint (dpdx, dpdy) fade out.
float FractalNoise(Point3 p, Vec3 dpdx, Vec3 dpdy, float roughness, int octaves);
// The same of absolute values; faded octaves count with their mean.
float Turbulence(Point3 p, Vec3 dpdx, Vec3 dpdy, float roughness, int octaves);

}  // namespace tessera
