// Rays, and the offset that keeps them from hitting the surface they start on.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "renderer/math/packed3.h"
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
inline Packed3 OffsetRayOrigin(Packed3 p, Packed3 error, Packed3 n, Packed3 w) {
  float d = Dot(Abs(n), error);
  if (Dot(w, n) < 0) d = -d;
  const Packed3 offset = n * d;
  const Packed3 po = p + offset;
  // The next float in the direction of the offset, lane by lane: NextFloatUp with the sign of the offset.
  const __m128 zero = _mm_setzero_ps();
  const __m128 sign = _mm_and_ps(offset.v, _mm_set1_ps(-0.0f));
  const __m128 along = _mm_xor_ps(po.v, sign);
  const __m128i is_positive = _mm_castps_si128(_mm_cmpgt_ps(along, zero));
  const __m128i step = _mm_sub_epi32(_mm_set1_epi32(-1), _mm_add_epi32(is_positive, is_positive));
  __m128 next = _mm_castsi128_ps(_mm_add_epi32(_mm_castps_si128(along), step));
  next =
      _mm_blendv_ps(next, _mm_set1_ps(std::numeric_limits<float>::denorm_min()), _mm_cmpeq_ps(along, zero));
  const __m128 is_finite = _mm_cmplt_ps(along, _mm_set1_ps(std::numeric_limits<float>::infinity()));
  const __m128 is_moved = _mm_and_ps(is_finite, _mm_cmp_ps(offset.v, zero, _CMP_NEQ_OQ));
  return _mm_blendv_ps(po.v, _mm_xor_ps(next, sign), is_moved);
}
inline Point3 OffsetRayOrigin(const Point3& p, const Vec3& error, const Normal3& n, const Vec3& w) {
  return OffsetRayOrigin(Packed3::Load(p), Packed3::Load(error), Packed3::Load(n), Packed3::Load(w)).Unpack();
}

}  // namespace tessera
