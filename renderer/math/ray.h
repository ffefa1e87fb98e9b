// Rays, and the offset that keeps them from hitting the surface they start on.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "renderer/math/vec.h"

namespace tessera {

// A half line. d need not be of unit length; t is measured in its length.
struct Ray {
  Point3 o;
  Vec3 d;
  float t_max = std::numeric_limits<float>::infinity();
  float time = 0;

  Point3 At(float t) const { return o + d * t; }
};

// The next float after v in the direction of +infinity or -infinity, as std::nextafterf finds it.
inline float NextFloatUp(float v) {
  if (!(v < std::numeric_limits<float>::infinity())) return v;  // or NaN
  if (v == 0) return std::numeric_limits<float>::denorm_min();
  const uint32_t bits = std::bit_cast<uint32_t>(v);
  return std::bit_cast<float>(v > 0 ? bits + 1 : bits - 1);
}
inline float NextFloatDown(float v) {
  return -NextFloatUp(-v);
}

// Bound of the relative error of n float operations in a row (Higham 2002).
constexpr float Gamma(int n) {
  constexpr float kHalfEpsilon = std::numeric_limits<float>::epsilon() * 0.5f;
  return (n * kHalfEpsilon) / (1 - n * kHalfEpsilon);
}

// A point on the side of the surface to which w points, outside the box of half size `error` around p: a ray
// from there cannot hit the surface at p again (Pharr, Jakob, Humphreys 2023, section 6.8.6). n is the unit
// normal.
inline Point3 OffsetRayOrigin(Point3 p, Vec3 error, Normal3 n, Vec3 w) {
  float d = Dot(Abs(n), error);
  if (Dot(w, n) < 0) d = -d;
  const Vec3 offset = n * d;
  Point3 po = p + offset;
  for (int i = 0; i < 3; ++i) {
    if (offset[i] > 0)
      po[i] = NextFloatUp(po[i]);
    else if (offset[i] < 0)
      po[i] = NextFloatDown(po[i]);
  }
  return po;
}

}  // namespace tessera
