#include "renderer/shape/shading_geometry.h"

#include "renderer/math/packed3.h"

namespace tessera {
namespace {

// The columns of an affine matrix.
struct PackedColumns {
  Packed3 x, y, z, translation;

  explicit PackedColumns(const Matrix4& matrix)
      : x(_mm_loadu_ps(matrix.m[0].data())),
        y(_mm_loadu_ps(matrix.m[1].data())),
        z(_mm_loadu_ps(matrix.m[2].data())),
        translation(_mm_setzero_ps()) {
    _MM_TRANSPOSE4_PS(x.v, y.v, z.v, translation.v);
  }
  // The linear part of the matrix of absolute values times a vector that has no negative components.
  Packed3 AbsTimes(Vec3 v) const { return Abs(x) * v.x + Abs(y) * v.y + Abs(z) * v.z; }
  // As TransformPoint of Double3.
  Packed3 Times(Double3 p) const {
    const auto scaled = [](Packed3 column, double s) {
      return _mm256_mul_pd(_mm256_cvtps_pd(column.v), _mm256_set1_pd(s));
    };
    const __m256d linear = _mm256_add_pd(_mm256_add_pd(scaled(x, p.x), scaled(y, p.y)), scaled(z, p.z));
    return _mm256_cvtpd_ps(_mm256_add_pd(linear, _mm256_cvtps_pd(translation.v)));
  }
};

}  // namespace

NormalDerivatives DifferentiateNormal(Vec3 dpdu, Vec3 dpdv, Vec3 d2pduu, Vec3 d2pduv, Vec3 d2pdvv) {
  const float E = Dot(dpdu, dpdu);
  const float F = Dot(dpdu, dpdv);
  const float G = Dot(dpdv, dpdv);
  const float determinant = DifferenceOfProducts(E, G, F, F);
  const Vec3 cross = Cross(dpdu, dpdv);
  if (determinant == 0 || LengthSquared(cross) == 0) return {};
  const Vec3 n = Normalize(cross);
  const float e = Dot(n, d2pduu);
  const float f = Dot(n, d2pduv);
  const float g = Dot(n, d2pdvv);
  const float inverse = 1 / determinant;
  return {dpdu * (DifferenceOfProducts(f, F, e, G) * inverse) +
              dpdv * (DifferenceOfProducts(e, F, f, E) * inverse),
          dpdu * (DifferenceOfProducts(g, F, f, G) * inverse) +
              dpdv * (DifferenceOfProducts(f, F, g, E) * inverse)};
}

Vec3 RotateFromTo(Vec3 v, Vec3 from, Vec3 to) {
  const float cosine = Dot(from, to);
  constexpr float kOpposite = -0.9999f;
  if (cosine > kOpposite) {  // Rodrigues' formula
    const Vec3 axis = Cross(from, to);
    const Vec3 turned = Cross(axis, v);
    return v + turned + Cross(axis, turned) * (1 / (1 + cosine));
  }
  // Two reflections: from -> middle -> to, where the middle is at right angles to both.
  Vec3 middle, other;
  CoordinateSystem(from, &middle, &other);
  const auto reflect = [](Vec3 w, Vec3 d) { return w - d * (2 * Dot(w, d) / LengthSquared(d)); };
  return reflect(reflect(v, middle - from), to - middle);
}

PointWithError TransformPointWithError(const Transform& transform, Double3 p, Vec3 error) {
  const PackedColumns m(transform.matrix()), inverse(transform.inverse_matrix());
  const Packed3 r = m.Times(p);
  const Packed3 there = m.AbsTimes(Abs(p.ToFloat())) + Abs(m.translation);
  const Packed3 back = inverse.AbsTimes(Abs(r).Unpack()) + Abs(inverse.translation);
  const Vec3 box = (Packed3(error) * (Gamma(3) + 1) + back * Gamma(5)).Unpack();
  return {r.Unpack(), (m.AbsTimes(box) + there * Gamma(3)).Unpack()};
}

}  // namespace tessera
