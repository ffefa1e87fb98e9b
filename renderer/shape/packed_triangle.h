// One triangle in registers: what a hit and a sampled point need of it.
#pragma once

#include "renderer/math/packed3.h"
#include "renderer/math/ray.h"
#include "renderer/shape/triangle.h"

namespace tessera {

// A ray in double registers, as DoubleRay. The fourth lanes are finite.
struct PackedDoubleRay {
  __m256d o, d;

  explicit PackedDoubleRay(const Ray& ray)
      : o(_mm256_cvtps_pd(Packed3::Load(ray.o).v)), d(_mm256_cvtps_pd(Packed3::Load(ray.d).v)) {}
  explicit PackedDoubleRay(const DoubleRay& ray)
      : o(_mm256_setr_pd(ray.o.x, ray.o.y, ray.o.z, 0)), d(_mm256_setr_pd(ray.d.x, ray.d.y, ray.d.z, 0)) {}
};

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
  // As CrossTriangle, with the bits of the same operations of Double3.
  bool Cross(const PackedDoubleRay& ray, TriangleCrossing* crossing) const {
    const __m256d corner = _mm256_cvtps_pd(p0.v);
    const __m256d e1 = _mm256_sub_pd(_mm256_cvtps_pd(p1.v), corner);
    const __m256d e2 = _mm256_sub_pd(_mm256_cvtps_pd(p2.v), corner);
    const __m256d s = _mm256_sub_pd(ray.o, corner);
    const __m256d p = CrossProduct(ray.d, e2), q = CrossProduct(s, e1);
    // The products of four dot products, transposed so that a lane holds each sum.
    const __m256d det = _mm256_mul_pd(e1, p), t = _mm256_mul_pd(e2, q);
    const __m256d u = _mm256_mul_pd(s, p), v = _mm256_mul_pd(ray.d, q);
    const __m256d xz0 = _mm256_unpacklo_pd(det, t), xz1 = _mm256_unpacklo_pd(u, v);
    const __m256d y0 = _mm256_unpackhi_pd(det, t), y1 = _mm256_unpackhi_pd(u, v);
    const __m256d x = _mm256_permute2f128_pd(xz0, xz1, 0x20), z = _mm256_permute2f128_pd(xz0, xz1, 0x31);
    const __m256d y = _mm256_permute2f128_pd(y0, y1, 0x20);
    const __m256d sums = _mm256_add_pd(_mm256_add_pd(x, y), z);
    const double determinant = _mm256_cvtsd_f64(sums);
    if (determinant == 0) return false;
    const __m256d results = _mm256_mul_pd(sums, _mm256_set1_pd(1 / determinant));
    const __m128d det_t = _mm256_castpd256_pd128(results), u_v = _mm256_extractf128_pd(results, 1);
    crossing->t = _mm_cvtsd_f64(_mm_unpackhi_pd(det_t, det_t));
    crossing->u = _mm_cvtsd_f64(u_v);
    crossing->v = _mm_cvtsd_f64(_mm_unpackhi_pd(u_v, u_v));
    return true;
  }
  // As TriangleWindingNormal.
  Packed3 WindingNormal() const {
    const Packed3 n = tessera::Cross(p0 - p2, p1 - p2);
    const float length_squared = LengthSquared(n);
    constexpr float kSafe = 1e-30f;  // no underflow in the squares
    if (length_squared > kSafe && length_squared < std::numeric_limits<float>::infinity()) [[likely]]
      return n / std::sqrt(length_squared);
    return NormalOfExtremeTriangle(Points());
  }

 private:
  static __m256d CrossProduct(__m256d a, __m256d b) {
    const auto yzx = [](__m256d r) { return _mm256_permute4x64_pd(r, _MM_SHUFFLE(3, 0, 2, 1)); };
    const auto zxy = [](__m256d r) { return _mm256_permute4x64_pd(r, _MM_SHUFFLE(3, 1, 0, 2)); };
    return _mm256_sub_pd(_mm256_mul_pd(yzx(a), zxy(b)), _mm256_mul_pd(zxy(a), yzx(b)));
  }
  TrianglePoints Points() const {
    TrianglePoints points;
    p0.Store(&points.p0);
    p1.Store(&points.p1);
    p2.Store(&points.p2);
    return points;
  }
};

}  // namespace tessera
