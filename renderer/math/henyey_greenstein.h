// The phase function of L. Henyey and J. Greenstein ("Diffuse Radiation in the Galaxy", 1941). It is
// normalised over the sphere, so it is its own density per solid angle. g is the mean cosine of the
// deflection.
#pragma once

#include <algorithm>
#include <cmath>

#include "renderer/math/vec.h"

namespace tessera {

// Per steradian. cos_theta is the cosine of the deflection: 1 is straight on.
inline float HenyeyGreenstein(float cos_theta, float g) {
  // Bounded for |g| near 1, where rounding can take it to zero.
  const float denominator = std::max(1 + g * g - 2 * g * cos_theta, 1e-6f);
  return kInv4Pi * (1 - g * g) / (denominator * std::sqrt(denominator));
}

// Two inverses of the distribution function of the cosine. They sample the same distribution from opposite
// ends (u = 0 is straight back for the first and straight on for the second), and round differently: media
// use the first and layered BxDFs the second, which fixes the bits of their pictures.

// The cosine of the deflection. Expanded, so that it holds for g = 0 too.
inline float SampleHenyeyGreensteinDeflection(float g, float u) {
  const float x = 2 * u - 1;
  const float gg = g * g;
  const float numerator = x * (1 + gg) + 0.5f * g * ((x * x + 3) + gg * (x * x - 1));
  return std::clamp(numerator / Sqr(1 + g * x), -1.0f, 1.0f);
}

// The cosine of the angle to where the light comes from, -1 if it goes straight on: pbrt-v4's form, which
// takes small |g| for 0 and then starts from the other end.
inline float SampleHenyeyGreensteinReturn(float g, float u) {
  if (!(std::abs(g) > 1e-3f)) return 1 - 2 * u;
  return -1 / (2 * g) * (1 + g * g - Sqr((1 - g * g) / (1 + g - 2 * g * u)));
}

// The unit vector at this cosine to the unit vector `axis`, at 2 pi u around it.
inline Vec3 DirectionAround(Vec3 axis, float cos_theta, float u) {
  const float sin_theta = SafeSqrt(1 - cos_theta * cos_theta);
  const float phi = 2 * kPi * u;
  return Frame::FromZ(axis).FromLocal({sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta});
}

}  // namespace tessera
