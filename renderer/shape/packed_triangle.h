// One triangle in registers: what a hit and a sampled point need of it.
#pragma once

#include "renderer/math/packed3.h"
#include "renderer/math/ray.h"
#include "renderer/shape/triangle.h"

namespace tessera {

struct PackedTriangle {
  Packed3 p0, p1, p2;

  explicit PackedTriangle(const TrianglePoints& points) : PackedTriangle(points.p0, points.p1, points.p2) {}
  PackedTriangle(const Point3& a, const Point3& b, const Point3& c)
      : p0(Packed3::Load(a)), p1(Packed3::Load(b)), p2(Packed3::Load(c)) {}

  // As TrianglePoint. In double: the point lies in the triangle's plane except for the last rounding.
  Packed3 PointAt(float u, float v) const {
    const __m256d o = _mm256_cvtps_pd(p0.v);
    const __m256d e1 = _mm256_sub_pd(_mm256_cvtps_pd(p1.v), o), e2 = _mm256_sub_pd(_mm256_cvtps_pd(p2.v), o);
    const __m256d along = _mm256_add_pd(o, _mm256_mul_pd(e1, _mm256_set1_pd(u)));
    return _mm256_cvtpd_ps(_mm256_add_pd(along, _mm256_mul_pd(e2, _mm256_set1_pd(v))));
  }
  // As TrianglePointError.
  Packed3 PointErrorAt(float u, float v) const {
    const Packed3 sum = Abs(p0 * (1 - u - v)) + Abs(p1 * u) + Abs(p2 * v);
    const Packed3 extent = Max(p0, Max(p1, p2)) - Min(p0, Min(p1, p2));
    return sum * Gamma(7) + extent * Gamma(3);
  }
  // As TriangleWindingNormal.
  Packed3 WindingNormal() const {
    const Packed3 n = Cross(p0 - p2, p1 - p2);
    const float length_squared = LengthSquared(n);
    constexpr float kSafe = 1e-30f;  // no underflow in the squares
    if (length_squared > kSafe && length_squared < std::numeric_limits<float>::infinity()) [[likely]]
      return n / std::sqrt(length_squared);
    return NormalOfExtremeTriangle(Points());
  }

 private:
  TrianglePoints Points() const {
    TrianglePoints points;
    p0.Store(&points.p0);
    p1.Store(&points.p1);
    p2.Store(&points.p2);
    return points;
  }
};

}  // namespace tessera
