#include "renderer/shape/shading_geometry.h"

namespace tessera {
namespace {

// The matrix of absolute values times a vector that has no negative components.
Vec3 AbsTimes(const Matrix4& matrix, Vec3 v) {
  const auto& m = matrix.m;
  Vec3 r;
  for (int i = 0; i < 3; ++i)
    r[i] = std::abs(m[i][0]) * v.x + std::abs(m[i][1]) * v.y + std::abs(m[i][2]) * v.z;
  return r;
}

Vec3 AbsTranslation(const Matrix4& m) {
  return {std::abs(m.m[0][3]), std::abs(m.m[1][3]), std::abs(m.m[2][3])};
}

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
  const Matrix4& m = transform.matrix();
  const Point3 r = TransformPoint(m, p).ToFloat();
  const Vec3 there = AbsTimes(m, Abs(p.ToFloat())) + AbsTranslation(m);
  const Matrix4& inverse = transform.inverse_matrix();
  const Vec3 back = AbsTimes(inverse, Abs(r)) + AbsTranslation(inverse);
  return {r, AbsTimes(m, error * (Gamma(3) + 1) + back * Gamma(5)) + there * Gamma(3)};
}

}  // namespace tessera
