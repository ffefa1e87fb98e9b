// A Vec3 in one SSE register, for code that computes with many of them. Every operation has the bits of the
// same operation of Vec3 (vec.h).
#pragma once

#include <immintrin.h>

#include "renderer/math/vec.h"

namespace tessera {

// The fourth lane is 0 after a load and may be anything after arithmetic.
struct Packed3 {
  __m128 v;

  Packed3(__m128 r) : v(r) {}
  Packed3(Vec3 a)
      : v(_mm_insert_ps(_mm_unpacklo_ps(_mm_set_ss(a.x), _mm_set_ss(a.y)), _mm_set_ss(a.z), 0x28)) {}
  // From memory.
  static Packed3 Load(const Vec3& a) {
    const __m128 xy = _mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(&a)));
    return _mm_insert_ps(xy, _mm_load_ss(&a.z), 0x28);
  }
  Vec3 Unpack() const {
    Vec3 a;
    Store(&a);
    return a;
  }
  void Store(Vec3* a) const {
    _mm_storel_epi64(reinterpret_cast<__m128i*>(a), _mm_castps_si128(v));
    _mm_store_ss(&a->z, _mm_movehl_ps(v, v));
  }
};

inline Packed3 operator+(Packed3 a, Packed3 b) {
  return _mm_add_ps(a.v, b.v);
}
inline Packed3 operator-(Packed3 a, Packed3 b) {
  return _mm_sub_ps(a.v, b.v);
}
inline Packed3 operator-(Packed3 a) {
  return _mm_xor_ps(a.v, _mm_set1_ps(-0.0f));
}
inline Packed3 operator*(Packed3 a, float s) {
  return _mm_mul_ps(a.v, _mm_set1_ps(s));
}
inline Packed3 operator/(Packed3 a, float s) {
  return a * (1 / s);
}
inline Packed3 Abs(Packed3 a) {
  return _mm_andnot_ps(_mm_set1_ps(-0.0f), a.v);
}
// The operands are exchanged: std::min and std::max return the first of equal values.
inline Packed3 Min(Packed3 a, Packed3 b) {
  return _mm_min_ps(b.v, a.v);
}
inline Packed3 Max(Packed3 a, Packed3 b) {
  return _mm_max_ps(b.v, a.v);
}
inline float Dot(Packed3 a, Packed3 b) {
  const __m128 products = _mm_mul_ps(a.v, b.v);
  const __m128 xy = _mm_add_ss(products, _mm_movehdup_ps(products));
  return _mm_cvtss_f32(_mm_add_ss(xy, _mm_movehl_ps(products, products)));
}
inline float LengthSquared(Packed3 a) {
  return Dot(a, a);
}
inline Packed3 Normalize(Packed3 a) {
  return a / std::sqrt(LengthSquared(a));
}
inline Packed3 FaceForward(Packed3 n, Packed3 v) {
  return Dot(n, v) < 0 ? -n : n;
}
// a * b - c * d, lane by lane, as DifferenceOfProducts of floats.
inline Packed3 DifferenceOfProducts(Packed3 a, Packed3 b, Packed3 c, Packed3 d) {
  const __m128 cd = _mm_mul_ps(c.v, d.v);
  const __m128 difference = _mm_fmsub_ps(a.v, b.v, cd);
  const __m128 error = _mm_fnmadd_ps(c.v, d.v, cd);
  return _mm_add_ps(difference, error);
}
inline Packed3 DifferenceOfProducts(float a, Packed3 b, float c, Packed3 d) {
  return DifferenceOfProducts(Packed3(_mm_set1_ps(a)), b, Packed3(_mm_set1_ps(c)), d);
}
inline Packed3 Cross(Packed3 a, Packed3 b) {
  const auto yzx = [](__m128 r) { return _mm_permute_ps(r, _MM_SHUFFLE(3, 0, 2, 1)); };
  const auto zxy = [](__m128 r) { return _mm_permute_ps(r, _MM_SHUFFLE(3, 1, 0, 2)); };
  return DifferenceOfProducts(Packed3(yzx(a.v)), zxy(b.v), zxy(a.v), yzx(b.v));
}

}  // namespace tessera
