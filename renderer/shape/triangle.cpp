#include "renderer/shape/triangle.h"

#include "renderer/shape/shading_geometry.h"

namespace tessera {
namespace {

struct TriangleNormals {
  Normal3 n0, n1, n2;
};

TriangleNormals NormalsAt(const TriangleMesh& mesh, uint32_t primitive) {
  const uint32_t* v = &mesh.indices[3 * size_t{primitive}];
  return {mesh.N[v[0]], mesh.N[v[1]], mesh.N[v[2]]};
}

Vec3 Interpolate(Vec3 a, Vec3 b, Vec3 c, float u, float v) {
  return a * (1 - u - v) + b * u + c * v;
}

// a * v - b * w, component by component, without cancellation.
Vec3 DifferenceOfProducts(float a, Vec3 v, float b, Vec3 w) {
  return {tessera::DifferenceOfProducts(a, v.x, b, w.x), tessera::DifferenceOfProducts(a, v.y, b, w.y),
          tessera::DifferenceOfProducts(a, v.z, b, w.z)};
}

// The map from changes of barycentrics to changes of texture coordinates, and its inverse applied to a
// quantity that is linear over the triangle: its derivatives by texture u and v.
class UvMap {
 public:
  explicit UvMap(const TriangleUv& uv) : d02_(uv.uv0 - uv.uv2), d12_(uv.uv1 - uv.uv2) {
    determinant_ = tessera::DifferenceOfProducts(d02_.x, d12_.y, d02_.y, d12_.x);
  }
  bool degenerate() const { return std::abs(determinant_) < kSmallestDeterminant; }
  // q02 is the quantity at vertex 0 minus that at vertex 2, q12 at 1 minus 2.
  Vec3 ByU(Vec3 q02, Vec3 q12) const {
    return DifferenceOfProducts(d12_.y, q02, d02_.y, q12) * (1 / determinant_);
  }
  Vec3 ByV(Vec3 q02, Vec3 q12) const {
    return DifferenceOfProducts(d02_.x, q12, d12_.x, q02) * (1 / determinant_);
  }

 private:
  static constexpr float kSmallestDeterminant = 1e-9f;  // as pbrt's
  Vec2 d02_, d12_;
  float determinant_;
};

// Derivatives of the shading normal by texture u and v.
void FillNormalDerivatives(const TriangleNormals& n, const UvMap& uv_map,
                           SurfaceInteraction::Shading* shading) {
  const Vec3 dn02 = n.n0 - n.n2;
  const Vec3 dn12 = n.n1 - n.n2;
  if (!uv_map.degenerate()) {
    shading->dndu = uv_map.ByU(dn02, dn12);
    shading->dndv = uv_map.ByV(dn02, dn12);
    return;
  }
  // By the same arbitrary parametrisation that stands in for dpdu and dpdv.
  const Vec3 dn = Cross(n.n2 - n.n0, n.n1 - n.n0);
  if (LengthSquared(dn) > 0) CoordinateSystem(Normalize(dn), &shading->dndu, &shading->dndv);
}

void FillShading(const TriangleMesh& mesh, uint32_t primitive, float u, float v, const UvMap& uv_map,
                 SurfaceInteraction* interaction) {
  Normal3 ns = interaction->n;
  SurfaceInteraction::Shading shading;
  if (!mesh.N.empty()) {
    const TriangleNormals n = NormalsAt(mesh, primitive);
    const Normal3 interpolated = Interpolate(n.n0, n.n1, n.n2, u, v);
    if (LengthSquared(interpolated) > 0) ns = Normalize(interpolated);
    FillNormalDerivatives(n, uv_map, &shading);
  }
  Vec3 ss = interaction->dpdu;
  if (!mesh.S.empty()) {
    const uint32_t* i = &mesh.indices[3 * size_t{primitive}];
    const Vec3 interpolated = Interpolate(mesh.S[i[0]], mesh.S[i[1]], mesh.S[i[2]], u, v);
    if (LengthSquared(interpolated) > 0) ss = interpolated;
  }
  Vec3 ts = Cross(ns, ss);
  if (LengthSquared(ts) > 0) {
    ss = Cross(ts, ns);
  } else {
    CoordinateSystem(ns, &ss, &ts);
  }
  shading.n = ns;
  shading.dpdu = ss;
  shading.dpdv = ts;
  SetShading(shading, interaction);
}

}  // namespace

TriangleUv TriangleUvAt(const TriangleMesh& mesh, uint32_t primitive) {
  if (mesh.uv.empty()) return {};
  const uint32_t* v = &mesh.indices[3 * size_t{primitive}];
  return {mesh.uv[v[0]], mesh.uv[v[1]], mesh.uv[v[2]]};
}

bool CrossTriangle(const TrianglePoints& triangle, const DoubleRay& ray, TriangleCrossing* crossing) {
  const Double3 e1 = Difference(triangle.p1, triangle.p0);
  const Double3 e2 = Difference(triangle.p2, triangle.p0);
  const Double3 p = Cross(ray.d, e2);
  const double determinant = Dot(e1, p);
  if (determinant == 0) return false;
  const double inverse = 1 / determinant;
  const Double3 s = ray.o - Double3(triangle.p0);
  const Double3 q = Cross(s, e1);
  crossing->t = Dot(e2, q) * inverse;
  crossing->u = Dot(s, p) * inverse;
  crossing->v = Dot(ray.d, q) * inverse;
  return true;
}

Normal3 TriangleWindingNormal(const TrianglePoints& triangle) {
  const Vec3 n = Cross(triangle.p0 - triangle.p2, triangle.p1 - triangle.p2);
  const float length_squared = LengthSquared(n);
  constexpr float kSafe = 1e-30f;  // no underflow in the squares
  if (length_squared > kSafe && length_squared < std::numeric_limits<float>::infinity()) {
    return n / std::sqrt(length_squared);
  }
  const Double3 exact = Cross(Difference(triangle.p0, triangle.p2), Difference(triangle.p1, triangle.p2));
  const double length = std::sqrt(Dot(exact, exact));
  return length > 0 ? (exact * (1 / length)).ToFloat() : Normal3{0, 0, 1};
}

Normal3 TriangleNormal(const TriangleMesh& mesh, uint32_t primitive, const TrianglePoints& triangle, float u,
                       float v) {
  Normal3 n = TriangleWindingNormal(triangle);
  if (mesh.flip_normals) n = -n;
  if (mesh.N.empty()) return n;
  const TriangleNormals normals = NormalsAt(mesh, primitive);
  const Normal3 ns = Interpolate(normals.n0, normals.n1, normals.n2, u, v);
  return LengthSquared(ns) > 0 ? FaceForward(n, ns) : n;
}

// In double: the point lies in the triangle's plane but for the last rounding.
Point3 TrianglePoint(const TrianglePoints& triangle, float u, float v) {
  const Double3 p0(triangle.p0);
  return (p0 + Difference(triangle.p1, triangle.p0) * u + Difference(triangle.p2, triangle.p0) * v).ToFloat();
}

Point2 TriangleTextureCoordinates(const TriangleMesh& mesh, uint32_t primitive, float u, float v) {
  const TriangleUv uv = TriangleUvAt(mesh, primitive);
  return uv.uv0 * (1 - u - v) + uv.uv1 * u + uv.uv2 * v;
}

Vec3 TrianglePointError(const TrianglePoints& triangle, float u, float v) {
  const Vec3 sum = Abs(triangle.p0 * (1 - u - v)) + Abs(triangle.p1 * u) + Abs(triangle.p2 * v);
  const Vec3 extent =
      Max(triangle.p0, Max(triangle.p1, triangle.p2)) - Min(triangle.p0, Min(triangle.p1, triangle.p2));
  return sum * Gamma(7) + extent * Gamma(3);
}

void FillTriangleInteraction(const TriangleMesh& mesh, uint32_t primitive, float u, float v,
                             SurfaceInteraction* interaction) {
  const TrianglePoints triangle = TriangleAt(mesh, primitive);
  const TriangleUv uv = TriangleUvAt(mesh, primitive);
  interaction->p = TrianglePoint(triangle, u, v);
  interaction->p_error = TrianglePointError(triangle, u, v);
  interaction->uv = uv.uv0 * (1 - u - v) + uv.uv1 * u + uv.uv2 * v;
  const Normal3 winding = TriangleWindingNormal(triangle);
  const UvMap uv_map(uv);
  bool degenerate = uv_map.degenerate();
  if (!degenerate) {
    const Vec3 dp02 = triangle.p0 - triangle.p2;
    const Vec3 dp12 = triangle.p1 - triangle.p2;
    interaction->dpdu = uv_map.ByU(dp02, dp12);
    interaction->dpdv = uv_map.ByV(dp02, dp12);
    degenerate = LengthSquared(Cross(interaction->dpdu, interaction->dpdv)) == 0;
  }
  if (degenerate) CoordinateSystem(-winding, &interaction->dpdu, &interaction->dpdv);
  interaction->n = mesh.flip_normals ? -winding : winding;
  if (mesh.N.empty() && mesh.S.empty()) {
    interaction->shading = {interaction->n, interaction->dpdu, interaction->dpdv, {}, {}};
  } else {
    FillShading(mesh, primitive, u, v, uv_map, interaction);
  }
}

}  // namespace tessera
