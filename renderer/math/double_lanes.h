// Eight doubles, one of each of eight paths (lanes.h).
#pragma once

#include "renderer/math/lanes.h"

namespace tessera {

struct Double8 {
  __m256d low, high;  // lanes 0 to 3, 4 to 7

  Double8(__m256d l, __m256d h) : low(l), high(h) {}
  explicit Double8(double c) : low(_mm256_set1_pd(c)), high(low) {}
  explicit Double8(Float8 f)
      : low(_mm256_cvtps_pd(_mm256_castps256_ps128(f.v))),
        high(_mm256_cvtps_pd(_mm256_extractf128_ps(f.v, 1))) {}
  // Rounded.
  Float8 ToFloat() const {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(low)), _mm256_cvtpd_ps(high), 1);
  }
};

inline Double8 operator+(Double8 a, Double8 b) {
  return {_mm256_add_pd(a.low, b.low), _mm256_add_pd(a.high, b.high)};
}
inline Double8 operator-(Double8 a, Double8 b) {
  return {_mm256_sub_pd(a.low, b.low), _mm256_sub_pd(a.high, b.high)};
}
inline Double8 operator*(Double8 a, Double8 b) {
  return {_mm256_mul_pd(a.low, b.low), _mm256_mul_pd(a.high, b.high)};
}
inline Double8 operator/(Double8 a, Double8 b) {
  return {_mm256_div_pd(a.low, b.low), _mm256_div_pd(a.high, b.high)};
}
// As std::min and std::max, which return the first of equal values.
inline Double8 Min(Double8 a, Double8 b) {
  return {_mm256_min_pd(b.low, a.low), _mm256_min_pd(b.high, a.high)};
}
inline Double8 Max(Double8 a, Double8 b) {
  return {_mm256_max_pd(b.low, a.low), _mm256_max_pd(b.high, a.high)};
}
// As std::clamp: NaN stays as it is.
inline Double8 Clamp(Double8 a, Double8 low, Double8 high) {
  const auto clamp = [](__m256d v, __m256d l, __m256d h) { return _mm256_min_pd(h, _mm256_max_pd(l, v)); };
  return {clamp(a.low, low.low, high.low), clamp(a.high, low.high, high.high)};
}
// In the order of lanes.
inline Mask8 JoinMasks(__m256d low, __m256d high) {
  const __m256 even = _mm256_shuffle_ps(_mm256_castpd_ps(low), _mm256_castpd_ps(high), 0x88);
  return {_mm256_castpd_ps(_mm256_permute4x64_pd(_mm256_castps_pd(even), _MM_SHUFFLE(3, 1, 2, 0)))};
}
inline Mask8 operator>(Double8 a, Double8 b) {
  return JoinMasks(_mm256_cmp_pd(a.low, b.low, _CMP_GT_OQ), _mm256_cmp_pd(a.high, b.high, _CMP_GT_OQ));
}
inline Mask8 operator==(Double8 a, Double8 b) {
  return JoinMasks(_mm256_cmp_pd(a.low, b.low, _CMP_EQ_OQ), _mm256_cmp_pd(a.high, b.high, _CMP_EQ_OQ));
}

struct Double3x8 {
  Double8 x, y, z;

  Double3x8(Double8 a, Double8 b, Double8 c) : x(a), y(b), z(c) {}
  explicit Double3x8(Vec3x8 v) : x(v.x), y(v.y), z(v.z) {}
  Vec3x8 ToFloat() const { return {x.ToFloat(), y.ToFloat(), z.ToFloat()}; }
};
inline Double3x8 operator+(Double3x8 a, Double3x8 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Double3x8 operator-(Double3x8 a, Double3x8 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Double3x8 operator*(Double3x8 a, Double8 s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline Double8 Dot(Double3x8 a, Double3x8 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Double3x8 Cross(Double3x8 a, Double3x8 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace tessera
