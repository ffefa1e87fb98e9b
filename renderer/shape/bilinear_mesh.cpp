#include "renderer/shape/bilinear_mesh.h"

#include <algorithm>

#include "renderer/shape/patch_intersection.h"
#include "renderer/shape/shading_geometry.h"

namespace tessera {
namespace {

struct CornerUv {
  Point2 uv00, uv10, uv01, uv11;
};
CornerUv CornerUvAt(const BilinearMesh& mesh, uint32_t primitive) {
  const uint32_t* v = &mesh.indices[4 * size_t{primitive}];
  return {mesh.uv[v[0]], mesh.uv[v[1]], mesh.uv[v[2]], mesh.uv[v[3]]};
}
struct CornerNormals {
  Normal3 n00, n10, n01, n11;
};
CornerNormals CornerNormalsAt(const BilinearMesh& mesh, uint32_t primitive) {
  const uint32_t* v = &mesh.indices[4 * size_t{primitive}];
  return {mesh.N[v[0]], mesh.N[v[1]], mesh.N[v[2]], mesh.N[v[3]]};
}

// Derivatives of patch parameters (u, v) by texture coordinates (s, t), taken one by one as pbrt does.
struct ParameterDerivatives {
  float duds = 1, dudt = 0, dvds = 0, dvdt = 1;

  Vec3 ByS(Vec3 by_u, Vec3 by_v) const { return by_u * duds + by_v * dvds; }
  Vec3 ByT(Vec3 by_u, Vec3 by_v) const { return by_u * dudt + by_v * dvdt; }
};

ParameterDerivatives DifferentiateParameters(const CornerUv& st, Point2 uv) {
  const Vec2 dstdu = DerivativeByU(uv, st.uv00, st.uv10, st.uv01, st.uv11);
  const Vec2 dstdv = DerivativeByV(uv, st.uv00, st.uv10, st.uv01, st.uv11);
  const auto invert = [](float d) { return std::abs(d) < 1e-8f ? 0 : 1 / d; };
  return {invert(dstdu.x), invert(dstdu.y), invert(dstdv.x), invert(dstdv.y)};
}

void FillShading(const BilinearMesh& mesh, uint32_t primitive, Point2 uv,
                 const ParameterDerivatives& parameters, SurfaceInteraction* interaction) {
  const CornerNormals n = CornerNormalsAt(mesh, primitive);
  const Normal3 interpolated = Bilinear(uv, n.n00, n.n10, n.n01, n.n11);
  if (!(LengthSquared(interpolated) > 0)) return;
  const Vec3 dndu = DerivativeByU(uv, n.n00, n.n10, n.n01, n.n11);
  const Vec3 dndv = DerivativeByV(uv, n.n00, n.n10, n.n01, n.n11);
  SurfaceInteraction::Shading shading;
  shading.n = Normalize(interpolated);
  shading.dpdu = RotateFromTo(interaction->dpdu, interaction->n, shading.n);
  shading.dpdv = RotateFromTo(interaction->dpdv, interaction->n, shading.n);
  shading.dndu = parameters.ByS(dndu, dndv);
  shading.dndv = parameters.ByT(dndu, dndv);
  SetShading(shading, interaction);
}

}  // namespace

uint64_t BilinearMesh::Bytes() const {
  return P.size() * sizeof(Point3) + N.size() * sizeof(Normal3) + uv.size() * sizeof(Point2) +
         indices.size() * sizeof(uint32_t);
}

bool BilinearMesh::Intersect(uint32_t primitive, const DoubleRay& ray, double t_max,
                             Crossing* crossing) const {
  return IntersectPatch(At(primitive), ray, t_max, crossing);
}

bool BilinearMesh::Refine(const HitRay& ray, Hit* hit) const {
  const PatchPoints patch = At(hit->primitive);
  Crossing refined;
  if (!IsParallelogram(patch) || !CrossParallelogram(patch, ray.InShapeSpace(), &refined)) return true;
  if (!(refined.t > 0)) return false;
  hit->t = static_cast<float>(std::min(refined.t, double{ray.ray.t_max}));
  hit->u = refined.u;
  hit->v = refined.v;
  return true;
}

void BilinearMesh::FillInteraction(const Hit& hit, const HitRay&, SurfaceInteraction* interaction) const {
  const Point2 place{hit.u, hit.v};
  const PatchPoints patch = At(hit.primitive);
  interaction->p = PatchPoint(patch, place);
  interaction->p_error = PatchPointError(patch);
  interaction->uv = TextureCoordinates(hit.primitive, place);
  auto [dpdu, dpdv] = DifferentiatePatch(patch, place);
  Vec3 cross = Cross(dpdu, dpdv);
  if (LengthSquared(cross) == 0) {  // a corner where two vertices meet, or no area at all
    cross = PatchCross(patch, {0.5f, 0.5f});
    if (LengthSquared(cross) == 0) cross = {0, 0, 1};
    CoordinateSystem(Normalize(cross), &dpdu, &dpdv);
  }
  const Vec3 d2pduv = (patch.p00 - patch.p01) + (patch.p11 - patch.p10);
  const NormalDerivatives dn = DifferentiateNormal(dpdu, dpdv, {}, d2pduv, {});
  ParameterDerivatives parameters;
  if (!uv.empty()) {
    parameters = DifferentiateParameters(CornerUvAt(*this, hit.primitive), place);
    const Vec3 dpds = parameters.ByS(dpdu, dpdv);
    Vec3 dpdt = parameters.ByT(dpdu, dpdv);
    const Vec3 cross_st = Cross(dpds, dpdt);
    if (!IsZero(cross_st)) {
      if (Dot(cross, cross_st) < 0) dpdt = -dpdt;
      dpdu = dpds;
      dpdv = dpdt;
    }
  }
  interaction->dpdu = dpdu;
  interaction->dpdv = dpdv;
  interaction->n = Normalize(cross);
  if (flip_normals) interaction->n = -interaction->n;
  interaction->shading = {interaction->n, dpdu, dpdv, parameters.ByS(dn.dndu, dn.dndv),
                          parameters.ByT(dn.dndu, dn.dndv)};
  if (!N.empty()) FillShading(*this, hit.primitive, place, parameters, interaction);
}

void BilinearMesh::FillHitPoint(const Hit& hit, const HitRay&, HitPoint* point) const {
  const Point2 place{hit.u, hit.v};
  point->uv = TextureCoordinates(hit.primitive, place);
  point->n = Normal(hit.primitive, At(hit.primitive), place);
}

Normal3 BilinearMesh::Normal(uint32_t primitive, const PatchPoints& patch, Point2 place) const {
  Vec3 cross = PatchCross(patch, place);
  if (LengthSquared(cross) == 0) cross = PatchCross(patch, {0.5f, 0.5f});  // a corner where two vertices meet
  Normal3 n = LengthSquared(cross) > 0 ? Normalize(cross) : Normal3{0, 0, 1};
  if (flip_normals) n = -n;
  if (N.empty()) return n;
  const CornerNormals normals = CornerNormalsAt(*this, primitive);
  return FaceForward(n, Bilinear(place, normals.n00, normals.n10, normals.n01, normals.n11));
}

Point2 BilinearMesh::TextureCoordinates(uint32_t primitive, Point2 place) const {
  if (uv.empty()) return place;
  const CornerUv st = CornerUvAt(*this, primitive);
  return Bilinear(place, st.uv00, st.uv10, st.uv01, st.uv11);
}

}  // namespace tessera
