#include "renderer/shape/triangle_mesh.h"

#include <algorithm>

#include "renderer/shape/shading_geometry.h"

namespace tessera {
namespace {

// Texture coordinates of the three corners; (0,0) (1,0) (1,1) if the mesh has none.
struct CornerUv {
  Point2 uv0{0, 0}, uv1{1, 0}, uv2{1, 1};

  Point2 At(float u, float v) const { return uv0 * (1 - u - v) + uv1 * u + uv2 * v; }
};
CornerUv UvAt(const TriangleMesh& mesh, uint32_t primitive) {
  if (mesh.uv.empty()) return {};
  const uint32_t* v = &mesh.indices[3 * size_t{primitive}];
  return {mesh.uv[v[0]], mesh.uv[v[1]], mesh.uv[v[2]]};
}

struct CornerNormals {
  Normal3 n0, n1, n2;
};
CornerNormals NormalsAt(const TriangleMesh& mesh, uint32_t primitive) {
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
  explicit UvMap(const CornerUv& uv) : d02_(uv.uv0 - uv.uv2), d12_(uv.uv1 - uv.uv2) {
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
void FillNormalDerivatives(const CornerNormals& n, const UvMap& uv_map,
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
    const CornerNormals n = NormalsAt(mesh, primitive);
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

uint64_t TriangleMesh::Bytes() const {
  return P.size() * sizeof(Point3) + N.size() * sizeof(Normal3) + S.size() * sizeof(Vec3) +
         uv.size() * sizeof(Point2) + indices.size() * sizeof(uint32_t);
}

bool TriangleMesh::Intersect(uint32_t primitive, const DoubleRay& ray, double t_max,
                             Crossing* crossing) const {
  TriangleCrossing c;
  if (!CrossTriangle(At(primitive), ray, &c)) return false;
  if (!(c.t > 0 && c.t <= t_max && c.u >= 0 && c.v >= 0 && c.u + c.v <= 1)) return false;
  *crossing = {c.t, static_cast<float>(c.u), static_cast<float>(c.v)};
  return true;
}

bool TriangleMesh::Refine(const HitRay& ray, Hit* hit) const {
  TriangleCrossing crossing;
  // Keeps hits on triangles that are seen edge on.
  if (!CrossTriangle(At(hit->primitive), ray.InShapeSpace(), &crossing)) return true;
  if (!(crossing.t > 0)) return false;
  const double u = std::clamp(crossing.u, 0.0, 1.0);
  hit->t = static_cast<float>(std::min(crossing.t, double{ray.ray.t_max}));
  hit->u = static_cast<float>(u);
  hit->v = static_cast<float>(std::clamp(crossing.v, 0.0, 1 - u));
  return true;
}

void TriangleMesh::FillInteraction(const Hit& hit, const HitRay&, SurfaceInteraction* interaction) const {
  const float u = hit.u, v = hit.v;
  const TrianglePoints triangle = At(hit.primitive);
  const CornerUv corner_uv = UvAt(*this, hit.primitive);
  interaction->p = TrianglePoint(triangle, u, v);
  interaction->p_error = TrianglePointError(triangle, u, v);
  interaction->uv = corner_uv.At(u, v);
  const Normal3 winding = TriangleWindingNormal(triangle);
  const UvMap uv_map(corner_uv);
  bool degenerate = uv_map.degenerate();
  if (!degenerate) {
    const Vec3 dp02 = triangle.p0 - triangle.p2;
    const Vec3 dp12 = triangle.p1 - triangle.p2;
    interaction->dpdu = uv_map.ByU(dp02, dp12);
    interaction->dpdv = uv_map.ByV(dp02, dp12);
    degenerate = LengthSquared(Cross(interaction->dpdu, interaction->dpdv)) == 0;
  }
  if (degenerate) CoordinateSystem(-winding, &interaction->dpdu, &interaction->dpdv);
  interaction->n = flip_normals ? -winding : winding;
  if (N.empty() && S.empty()) {
    interaction->shading = {interaction->n, interaction->dpdu, interaction->dpdv, {}, {}};
  } else {
    FillShading(*this, hit.primitive, u, v, uv_map, interaction);
  }
}

void TriangleMesh::FillHitPoint(const Hit& hit, const HitRay&, HitPoint* point) const {
  point->uv = TextureCoordinates(hit.primitive, hit.u, hit.v);
  point->n = Normal(hit.primitive, At(hit.primitive), hit.u, hit.v);
}

Normal3 TriangleMesh::Normal(uint32_t primitive, const TrianglePoints& triangle, float u, float v) const {
  Normal3 n = TriangleWindingNormal(triangle);
  if (flip_normals) n = -n;
  if (N.empty()) return n;
  const CornerNormals normals = NormalsAt(*this, primitive);
  const Normal3 ns = Interpolate(normals.n0, normals.n1, normals.n2, u, v);
  return LengthSquared(ns) > 0 ? FaceForward(n, ns) : n;
}

Point2 TriangleMesh::TextureCoordinates(uint32_t primitive, float u, float v) const {
  return UvAt(*this, primitive).At(u, v);
}

}  // namespace tessera
