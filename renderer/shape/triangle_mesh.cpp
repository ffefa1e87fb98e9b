#include "renderer/shape/triangle_mesh.h"

#include <algorithm>

#include "renderer/shape/packed_triangle.h"
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

Packed3 Interpolate(Packed3 a, Packed3 b, Packed3 c, float u, float v) {
  return a * (1 - u - v) + b * u + c * v;
}

// Two unit vectors across unit n.
struct Tangents {
  Packed3 u, v;
};
Tangents AnyTangents(Packed3 n) {
  Vec3 u, v;
  CoordinateSystem(n.Unpack(), &u, &v);
  return {u, v};
}

// The map from changes of barycentrics to changes of texture coordinates, and its inverse applied to a
// quantity that is linear over the triangle: its derivatives by texture u and v.
class UvMap {
 public:
  explicit UvMap(const CornerUv& uv) : d02_(uv.uv0 - uv.uv2), d12_(uv.uv1 - uv.uv2) {
    determinant_ = DifferenceOfProducts(d02_.x, d12_.y, d02_.y, d12_.x);
    inverse_ = 1 / determinant_;
  }
  bool degenerate() const { return std::abs(determinant_) < kSmallestDeterminant; }
  // q02 is the quantity at vertex 0 minus that at vertex 2, q12 at 1 minus 2.
  Packed3 ByU(Packed3 q02, Packed3 q12) const {
    return DifferenceOfProducts(d12_.y, q02, d02_.y, q12) * inverse_;
  }
  Packed3 ByV(Packed3 q02, Packed3 q12) const {
    return DifferenceOfProducts(d02_.x, q12, d12_.x, q02) * inverse_;
  }

 private:
  static constexpr float kSmallestDeterminant = 1e-9f;  // as pbrt's
  Vec2 d02_, d12_;
  float determinant_, inverse_;
};

// Derivatives of the shading normal by texture u and v.
void FillNormalDerivatives(Packed3 n0, Packed3 n1, Packed3 n2, const UvMap& uv_map,
                           SurfaceInteraction::Shading* shading) {
  if (!uv_map.degenerate()) {
    const Packed3 dn02 = n0 - n2, dn12 = n1 - n2;
    uv_map.ByU(dn02, dn12).Store(&shading->dndu);
    uv_map.ByV(dn02, dn12).Store(&shading->dndv);
    return;
  }
  // By the same arbitrary parametrisation that stands in for dpdu and dpdv.
  const Packed3 dn = Cross(n2 - n0, n1 - n0);
  if (LengthSquared(dn) > 0) CoordinateSystem(Normalize(dn).Unpack(), &shading->dndu, &shading->dndv);
}

// The normals of a mesh at its corners.
struct PackedNormals {
  Packed3 n0, n1, n2;

  PackedNormals(const TriangleMesh& mesh, const uint32_t* corners)
      : n0(Packed3::Load(mesh.N[corners[0]])),
        n1(Packed3::Load(mesh.N[corners[1]])),
        n2(Packed3::Load(mesh.N[corners[2]])) {}
  // Interpolated and unit; n if they cancel.
  Packed3 At(const Hit& hit, Packed3 n) const {
    const Packed3 interpolated = Interpolate(n0, n1, n2, hit.u, hit.v);
    const float length_squared = LengthSquared(interpolated);
    return length_squared > 0 ? interpolated / std::sqrt(length_squared) : n;
  }
};

// n is the geometric normal.
void FillNormals(const TriangleMesh& mesh, const uint32_t* corners, const Hit& hit, Packed3 n,
                 SurfaceInteraction* interaction) {
  const Packed3 ns = mesh.N.empty() ? n : PackedNormals(mesh, corners).At(hit, n);
  ns.Store(&interaction->shading.n);
  FaceForward(n, ns).Store(&interaction->n);
}

// Of a mesh with normals or tangents. n is the geometric normal and dpdu its tangent.
void FillShading(const TriangleMesh& mesh, const uint32_t* corners, const Hit& hit, const UvMap& uv_map,
                 bool needs_normal_derivatives, Packed3 n, Packed3 dpdu, SurfaceInteraction* interaction) {
  SurfaceInteraction::Shading& shading = interaction->shading;
  Packed3 ns = n;
  if (!mesh.N.empty()) {
    const PackedNormals normals(mesh, corners);
    ns = normals.At(hit, n);
    if (needs_normal_derivatives) FillNormalDerivatives(normals.n0, normals.n1, normals.n2, uv_map, &shading);
  }
  Packed3 ss = dpdu;
  if (!mesh.S.empty()) {
    const Packed3 interpolated =
        Interpolate(Packed3::Load(mesh.S[corners[0]]), Packed3::Load(mesh.S[corners[1]]),
                    Packed3::Load(mesh.S[corners[2]]), hit.u, hit.v);
    if (LengthSquared(interpolated) > 0) ss = interpolated;
  }
  Packed3 ts = Cross(ns, ss);
  if (LengthSquared(ts) > 0) {
    ss = Cross(ts, ns);
  } else {
    const Tangents any = AnyTangents(ns);
    ss = any.u;
    ts = any.v;
  }
  ns.Store(&shading.n);
  ss.Store(&shading.dpdu);
  ts.Store(&shading.dpdv);
  FaceForward(n, ns).Store(&interaction->n);
  BoundTangents(&shading);
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
  const uint32_t* const corners = &indices[3 * size_t{hit->primitive}];
  const PackedTriangle triangle(P[corners[0]], P[corners[1]], P[corners[2]]);
  const PackedDoubleRay packed_ray =
      ray.render_from_group == nullptr ? PackedDoubleRay(ray.ray) : PackedDoubleRay(ray.InShapeSpace());
  TriangleCrossing crossing;
  // Keeps hits on triangles that are seen edge on.
  if (!triangle.Cross(packed_ray, &crossing)) return true;
  if (!(crossing.t > 0)) return false;
  const double u = std::clamp(crossing.u, 0.0, 1.0);
  hit->t = static_cast<float>(std::min(crossing.t, double{ray.ray.t_max}));
  hit->u = static_cast<float>(u);
  hit->v = static_cast<float>(std::clamp(crossing.v, 0.0, 1 - u));
  return true;
}

void TriangleMesh::FillInteraction(const Hit& hit, const HitRay& ray, SurfaceInteraction* interaction) const {
  const float u = hit.u, v = hit.v;
  const uint32_t* const corners = &indices[3 * size_t{hit.primitive}];
  const PackedTriangle triangle(P[corners[0]], P[corners[1]], P[corners[2]]);
  const CornerUv corner_uv = UvAt(*this, hit.primitive);
  triangle.PointAt(u, v).Store(&interaction->p);
  triangle.PointErrorAt(u, v).Store(&interaction->p_error);
  interaction->uv = corner_uv.At(u, v);
  const Packed3 winding = triangle.WindingNormal();
  const Packed3 n = flip_normals ? -winding : winding;
  if (!ray.needs_tangents) return FillNormals(*this, corners, hit, n, interaction);
  const UvMap uv_map(corner_uv);
  const Packed3 dp02 = triangle.p0 - triangle.p2, dp12 = triangle.p1 - triangle.p2;
  Tangents tangents{uv_map.ByU(dp02, dp12), uv_map.ByV(dp02, dp12)};
  if (uv_map.degenerate() || LengthSquared(Cross(tangents.u, tangents.v)) == 0)
    tangents = AnyTangents(-winding);
  tangents.u.Store(&interaction->dpdu);
  tangents.v.Store(&interaction->dpdv);
  if (N.empty() && S.empty()) {
    SurfaceInteraction::Shading& shading = interaction->shading;
    n.Store(&interaction->n);
    n.Store(&shading.n);
    tangents.u.Store(&shading.dpdu);
    tangents.v.Store(&shading.dpdv);
  } else {
    FillShading(*this, corners, hit, uv_map, ray.needs_normal_derivatives, n, tangents.u, interaction);
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
