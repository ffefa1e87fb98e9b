// Gradient noise (K. Perlin, "An Image Synthesizer", 1985, and "Improving Noise", 2002) and sums of its
// octaves, band-limited by the footprint. Pure functions.
#pragma once

#include "renderer/math/vec.h"

namespace tessera {

// In about [-1, 1]; 0 at integer points, smooth in between.
float Noise(Point3 p);

// A sum of octaves, each with 1.99 times the frequency and `roughness` times the amplitude of the one before.
// Octaves finer than the footprint (dpdx, dpdy) fade out.
float FractalNoise(Point3 p, Vec3 dpdx, Vec3 dpdy, float roughness, int octaves);
// The same of absolute values; faded octaves contribute their mean.
float Turbulence(Point3 p, Vec3 dpdx, Vec3 dpdy, float roughness, int octaves);

}  // namespace tessera
