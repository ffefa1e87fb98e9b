// Four floats in one SSE register, element by element.
#pragma once

#include <immintrin.h>

#include <cmath>

namespace tessera {

struct Float4 {
  __m128 v;

  Float4() : v(_mm_setzero_ps()) {}
  Float4(__m128 r) : v(r) {}
  explicit Float4(float c) : v(_mm_set1_ps(c)) {}
  Float4(float a, float b, float c, float d) : v(_mm_setr_ps(a, b, c, d)) {}

  float operator[](int i) const {
    alignas(16) float f[4];
    _mm_store_ps(f, v);
    return f[i];
  }
  void Set(int i, float value) {
    alignas(16) float f[4];
    _mm_store_ps(f, v);
    f[i] = value;
    v = _mm_load_ps(f);
  }
};

inline Float4 operator+(Float4 a, Float4 b) {
  return _mm_add_ps(a.v, b.v);
}
inline Float4 operator-(Float4 a, Float4 b) {
  return _mm_sub_ps(a.v, b.v);
}
inline Float4 operator*(Float4 a, Float4 b) {
  return _mm_mul_ps(a.v, b.v);
}
inline Float4 operator/(Float4 a, Float4 b) {
  return _mm_div_ps(a.v, b.v);
}
inline Float4 operator*(Float4 a, float s) {
  return a * Float4(s);
}
inline Float4 operator*(float s, Float4 a) {
  return a * Float4(s);
}
inline Float4 operator/(Float4 a, float s) {
  return a / Float4(s);
}
inline Float4 operator+(Float4 a, float s) {
  return a + Float4(s);
}
inline Float4 operator-(float s, Float4 a) {
  return Float4(s) - a;
}
inline Float4 operator/(float s, Float4 a) {
  return Float4(s) / a;
}
inline Float4 operator-(Float4 a) {
  return _mm_xor_ps(a.v, _mm_set1_ps(-0.0f));
}
inline Float4& operator+=(Float4& a, Float4 b) {
  return a = a + b;
}
inline Float4& operator*=(Float4& a, Float4 b) {
  return a = a * b;
}
inline Float4& operator*=(Float4& a, float s) {
  return a = a * s;
}
inline Float4& operator/=(Float4& a, float s) {
  return a = a / s;
}

inline Float4 operator-(Float4 a, float s) {
  return a - Float4(s);
}
inline Float4 Abs(Float4 a) {
  return _mm_andnot_ps(_mm_set1_ps(-0.0f), a.v);
}
inline Float4 Min(Float4 a, Float4 b) {
  return _mm_min_ps(a.v, b.v);
}
inline Float4 Max(Float4 a, Float4 b) {
  return _mm_max_ps(a.v, b.v);
}
inline Float4 Sqrt(Float4 a) {
  return _mm_sqrt_ps(a.v);
}
inline Float4 SafeSqrt(Float4 a) {
  return _mm_sqrt_ps(_mm_max_ps(a.v, _mm_setzero_ps()));
}
// a / b where b is not 0, else 0.
inline Float4 SafeDiv(Float4 a, Float4 b) {
  const __m128 zero = _mm_cmpeq_ps(b.v, _mm_setzero_ps());
  return _mm_andnot_ps(zero, _mm_div_ps(a.v, b.v));
}

// (f0 + f1) + (f2 + f3): always in this order.
inline float Sum(Float4 a) {
  const __m128 swapped = _mm_shuffle_ps(a.v, a.v, _MM_SHUFFLE(2, 3, 0, 1));
  const __m128 pairs = _mm_add_ps(a.v, swapped);
  return _mm_cvtss_f32(_mm_add_ss(pairs, _mm_movehl_ps(pairs, pairs)));
}
inline float Average(Float4 a) {
  return Sum(a) * 0.25f;
}
inline float MaxElement(Float4 a) {
  const __m128 pairs = _mm_max_ps(a.v, _mm_shuffle_ps(a.v, a.v, _MM_SHUFFLE(2, 3, 0, 1)));
  return _mm_cvtss_f32(_mm_max_ss(pairs, _mm_movehl_ps(pairs, pairs)));
}
// Whether any element is not 0.
inline bool AnyNonZero(Float4 a) {
  return _mm_movemask_ps(_mm_cmpneq_ps(a.v, _mm_setzero_ps())) != 0;
}
inline bool AllFinite(Float4 a) {
  const __m128 magnitude = _mm_andnot_ps(_mm_set1_ps(-0.0f), a.v);
  return _mm_movemask_ps(_mm_cmplt_ps(magnitude, _mm_set1_ps(INFINITY))) == 15;
}
// By the float function of the C library, element by element: its bits do not depend on the machine.
inline Float4 Exp(Float4 a) {
  alignas(16) float f[4];
  _mm_store_ps(f, a.v);
  return {std::exp(f[0]), std::exp(f[1]), std::exp(f[2]), std::exp(f[3])};
}

}  // namespace tessera
