// Eight numbers in AVX registers, one of each of eight paths that are followed at the same time. Every
// operation has the bits of the same operation of floats, doubles and Vec3, lane by lane.
#pragma once

#include <immintrin.h>

#include <bit>
#include <cstdint>
#include <limits>

#include "renderer/math/vec.h"

namespace tessera {

constexpr int kLanes = 8;

// Bit i: lane i.
using LaneSet = uint32_t;
constexpr LaneSet kAllLanes = (LaneSet{1} << kLanes) - 1;
constexpr bool HasLane(LaneSet lanes, int lane) {
  return (lanes >> lane & 1) != 0;
}
// Calls function(lane) for each lane of the set.
template <typename Function>
inline void ForEachLane(LaneSet lanes, Function&& function) {
  for (; lanes != 0; lanes &= lanes - 1) function(std::countr_zero(lanes));
}

// A condition in each lane: all bits set where it holds.
struct Mask8 {
  __m256 v;

  LaneSet lanes() const { return static_cast<LaneSet>(_mm256_movemask_ps(v)); }
};
inline Mask8 operator&(Mask8 a, Mask8 b) {
  return {_mm256_and_ps(a.v, b.v)};
}
inline Mask8 MaskOf(LaneSet lanes) {
  const __m256i bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  const __m256i set = _mm256_and_si256(_mm256_set1_epi32(static_cast<int>(lanes)), bits);
  return {_mm256_castsi256_ps(_mm256_cmpeq_epi32(set, bits))};
}

struct Float8 {
  __m256 v;

  Float8() : v(_mm256_setzero_ps()) {}
  Float8(__m256 r) : v(r) {}
  explicit Float8(float c) : v(_mm256_set1_ps(c)) {}
  // From memory that need not be aligned.
  static Float8 Load(const float* lanes) { return _mm256_loadu_ps(lanes); }
  void Store(float* lanes) const { _mm256_storeu_ps(lanes, v); }
};

inline Float8 operator+(Float8 a, Float8 b) {
  return _mm256_add_ps(a.v, b.v);
}
inline Float8 operator-(Float8 a, Float8 b) {
  return _mm256_sub_ps(a.v, b.v);
}
inline Float8 operator*(Float8 a, Float8 b) {
  return _mm256_mul_ps(a.v, b.v);
}
inline Float8 operator/(Float8 a, Float8 b) {
  return _mm256_div_ps(a.v, b.v);
}
inline Float8 operator-(Float8 a) {
  return _mm256_xor_ps(a.v, _mm256_set1_ps(-0.0f));
}
inline Mask8 operator<(Float8 a, Float8 b) {
  return {_mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ)};
}
inline Mask8 operator>(Float8 a, Float8 b) {
  return {_mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ)};
}
inline Mask8 operator<=(Float8 a, Float8 b) {
  return {_mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ)};
}
inline Mask8 operator==(Float8 a, Float8 b) {
  return {_mm256_cmp_ps(a.v, b.v, _CMP_EQ_OQ)};
}
// `a` where the mask is set, else `b`.
inline Float8 Select(Mask8 mask, Float8 a, Float8 b) {
  return _mm256_blendv_ps(b.v, a.v, mask.v);
}
inline Float8 Abs(Float8 a) {
  return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v);
}
// As std::min and std::max, which return the first of equal values.
inline Float8 Min(Float8 a, Float8 b) {
  return _mm256_min_ps(b.v, a.v);
}
inline Float8 Max(Float8 a, Float8 b) {
  return _mm256_max_ps(b.v, a.v);
}
inline Float8 Sqrt(Float8 a) {
  return _mm256_sqrt_ps(a.v);
}
inline Float8 SafeSqrt(Float8 a) {
  return Sqrt(Max(Float8(0.0f), a));
}
inline Float8 CopySign(Float8 magnitude, Float8 sign) {
  const __m256 bit = _mm256_set1_ps(-0.0f);
  return _mm256_or_ps(_mm256_andnot_ps(bit, magnitude.v), _mm256_and_ps(bit, sign.v));
}
inline Float8 Lerp(Float8 t, Float8 a, Float8 b) {
  return (Float8(1) - t) * a + t * b;
}
// -a in the lanes of the mask.
inline Float8 NegateWhere(Mask8 mask, Float8 a) {
  return _mm256_xor_ps(a.v, _mm256_and_ps(mask.v, _mm256_set1_ps(-0.0f)));
}
inline Float8 DifferenceOfProducts(Float8 a, Float8 b, Float8 c, Float8 d) {
  const __m256 cd = _mm256_mul_ps(c.v, d.v);
  const __m256 difference = _mm256_fmsub_ps(a.v, b.v, cd);
  const __m256 error = _mm256_fnmadd_ps(c.v, d.v, cd);
  return _mm256_add_ps(difference, error);
}

struct Vec2x8 {
  Float8 x, y;
};

// A vector in each lane.
struct Vec3x8 {
  Float8 x, y, z;

  Vec3x8() = default;
  Vec3x8(Float8 a, Float8 b, Float8 c) : x(a), y(b), z(c) {}
  // The same in all lanes.
  explicit Vec3x8(Vec3 v) : x(v.x), y(v.y), z(v.z) {}
};
inline Vec3x8 operator+(Vec3x8 a, Vec3x8 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3x8 operator-(Vec3x8 a, Vec3x8 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3x8 operator-(Vec3x8 a) {
  return {-a.x, -a.y, -a.z};
}
inline Vec3x8 operator*(Vec3x8 a, Float8 s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline Vec3x8 operator/(Vec3x8 a, Float8 s) {
  return a * (Float8(1) / s);
}
inline Vec3x8 Abs(Vec3x8 a) {
  return {Abs(a.x), Abs(a.y), Abs(a.z)};
}
inline Vec3x8 Min(Vec3x8 a, Vec3x8 b) {
  return {Min(a.x, b.x), Min(a.y, b.y), Min(a.z, b.z)};
}
inline Vec3x8 Max(Vec3x8 a, Vec3x8 b) {
  return {Max(a.x, b.x), Max(a.y, b.y), Max(a.z, b.z)};
}
inline Vec3x8 Select(Mask8 mask, Vec3x8 a, Vec3x8 b) {
  return {Select(mask, a.x, b.x), Select(mask, a.y, b.y), Select(mask, a.z, b.z)};
}
inline Vec3x8 NegateWhere(Mask8 mask, Vec3x8 a) {
  return {NegateWhere(mask, a.x), NegateWhere(mask, a.y), NegateWhere(mask, a.z)};
}
inline Float8 Dot(Vec3x8 a, Vec3x8 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Float8 LengthSquared(Vec3x8 a) {
  return Dot(a, a);
}
inline Vec3x8 Normalize(Vec3x8 a) {
  return a / Sqrt(LengthSquared(a));
}
inline Vec3x8 Cross(Vec3x8 a, Vec3x8 b) {
  return {DifferenceOfProducts(a.y, b.z, a.z, b.y), DifferenceOfProducts(a.z, b.x, a.x, b.z),
          DifferenceOfProducts(a.x, b.y, a.y, b.x)};
}
inline Vec3x8 FaceForward(Vec3x8 n, Vec3x8 v) {
  return NegateWhere(Dot(n, v) < Float8(0), n);
}

// As Frame::FromZ. `z` is the third axis.
struct Frame8 {
  Vec3x8 x, y;

  explicit Frame8(Vec3x8 z) {
    const Float8 one(1.0f);
    const Float8 sign = CopySign(one, z.z);
    const Float8 a = Float8(-1.0f) / (sign + z.z);
    const Float8 b = z.x * z.y * a;
    x = {one + sign * z.x * z.x * a, sign * b, -sign * z.x};
    y = {b, sign + z.y * z.y * a, -z.y};
  }
};

// Four floats of each lane, from eight places: rows of registers become lanes.
struct Rows8 {
  Float8 a, b, c, d;
};
inline Rows8 Transpose(const __m128 (&r)[kLanes]) {
  const auto pair = [](__m128 low, __m128 high) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(low), high, 1);
  };
  const __m256 r04 = pair(r[0], r[4]), r15 = pair(r[1], r[5]), r26 = pair(r[2], r[6]), r37 = pair(r[3], r[7]);
  const __m256 ab01 = _mm256_unpacklo_ps(r04, r15), cd01 = _mm256_unpackhi_ps(r04, r15);
  const __m256 ab23 = _mm256_unpacklo_ps(r26, r37), cd23 = _mm256_unpackhi_ps(r26, r37);
  return {_mm256_shuffle_ps(ab01, ab23, 0x44), _mm256_shuffle_ps(ab01, ab23, 0xee),
          _mm256_shuffle_ps(cd01, cd23, 0x44), _mm256_shuffle_ps(cd01, cd23, 0xee)};
}
// The four floats of each lane, in one register for each lane.
struct Quads {
  __m128 lane[kLanes];
};
inline Quads Untranspose(Float8 a, Float8 b, Float8 c, Float8 d) {
  const __m256 ab_low = _mm256_unpacklo_ps(a.v, b.v), ab_high = _mm256_unpackhi_ps(a.v, b.v);
  const __m256 cd_low = _mm256_unpacklo_ps(c.v, d.v), cd_high = _mm256_unpackhi_ps(c.v, d.v);
  const __m256 r04 = _mm256_shuffle_ps(ab_low, cd_low, 0x44), r15 = _mm256_shuffle_ps(ab_low, cd_low, 0xee);
  const __m256 r26 = _mm256_shuffle_ps(ab_high, cd_high, 0x44),
               r37 = _mm256_shuffle_ps(ab_high, cd_high, 0xee);
  const auto low = [](__m256 r) { return _mm256_castps256_ps128(r); };
  const auto high = [](__m256 r) { return _mm256_extractf128_ps(r, 1); };
  return {{low(r04), low(r15), low(r26), low(r37), high(r04), high(r15), high(r26), high(r37)}};
}

}  // namespace tessera
