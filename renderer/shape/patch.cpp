#include "renderer/shape/patch.h"

#include "renderer/shape/shading_geometry.h"

namespace tessera {
namespace {

template <typename T>
T Bilinear(Point2 uv, T v00, T v10, T v01, T v11) {
  return (v00 * (1 - uv.y) + v01 * uv.y) * (1 - uv.x) + (v10 * (1 - uv.y) + v11 * uv.y) * uv.x;
}
template <typename T>
T DerivativeByU(Point2 uv, T v00, T v10, T v01, T v11) {
  return (v10 * (1 - uv.y) + v11 * uv.y) - (v00 * (1 - uv.y) + v01 * uv.y);
}
template <typename T>
T DerivativeByV(Point2 uv, T v00, T v10, T v01, T v11) {
  return (v01 * (1 - uv.x) + v11 * uv.x) - (v00 * (1 - uv.x) + v10 * uv.x);
}

struct PatchUv {
  Point2 uv00, uv10, uv01, uv11;
};
PatchUv PatchUvAt(const BilinearMesh& mesh, uint32_t primitive) {
  const uint32_t* v = &mesh.indices[4 * size_t{primitive}];
  return {mesh.uv[v[0]], mesh.uv[v[1]], mesh.uv[v[2]], mesh.uv[v[3]]};
}
struct PatchNormals {
  Normal3 n00, n10, n01, n11;
};
PatchNormals PatchNormalsAt(const BilinearMesh& mesh, uint32_t primitive) {
  const uint32_t* v = &mesh.indices[4 * size_t{primitive}];
  return {mesh.N[v[0]], mesh.N[v[1]], mesh.N[v[2]], mesh.N[v[3]]};
}

// Derivatives of patch parameters (u, v) by texture coordinates (s, t), taken one by one as pbrt does.
struct ParameterDerivatives {
  float duds = 1, dudt = 0, dvds = 0, dvdt = 1;

  Vec3 ByS(Vec3 by_u, Vec3 by_v) const { return by_u * duds + by_v * dvds; }
  Vec3 ByT(Vec3 by_u, Vec3 by_v) const { return by_u * dudt + by_v * dvdt; }
};

ParameterDerivatives DifferentiateParameters(const PatchUv& st, Point2 uv) {
  const Vec2 dstdu = DerivativeByU(uv, st.uv00, st.uv10, st.uv01, st.uv11);
  const Vec2 dstdv = DerivativeByV(uv, st.uv00, st.uv10, st.uv01, st.uv11);
  const auto invert = [](float d) { return std::abs(d) < 1e-8f ? 0 : 1 / d; };
  return {invert(dstdu.x), invert(dstdu.y), invert(dstdv.x), invert(dstdv.y)};
}

void FillShading(const BilinearMesh& mesh, uint32_t primitive, Point2 uv,
                 const ParameterDerivatives& parameters, SurfaceInteraction* interaction) {
  const PatchNormals n = PatchNormalsAt(mesh, primitive);
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

Point3 PatchPoint(const PatchPoints& patch, Point2 uv) {
  const Double3 v0 = Lerp(uv.x, Double3(patch.p00), Double3(patch.p10));
  const Double3 v1 = Lerp(uv.x, Double3(patch.p01), Double3(patch.p11));
  return Lerp(uv.y, v0, v1).ToFloat();
}

Vec3 PatchPointError(const PatchPoints& patch) {
  return (Abs(patch.p00) + Abs(patch.p10) + Abs(patch.p01) + Abs(patch.p11)) * Gamma(6);
}

PatchDerivatives DifferentiatePatch(const PatchPoints& patch, Point2 uv) {
  return {DerivativeByU(uv, patch.p00, patch.p10, patch.p01, patch.p11),
          DerivativeByV(uv, patch.p00, patch.p10, patch.p01, patch.p11)};
}

Vec3 PatchCross(const PatchPoints& patch, Point2 uv) {
  const PatchDerivatives d = DifferentiatePatch(patch, uv);
  return Cross(d.dpdu, d.dpdv);
}

bool IsParallelogram(const PatchPoints& patch) {
  const Vec3 gap = (patch.p00 - patch.p10) + (patch.p11 - patch.p01);
  const Vec3 largest = Max(Max(Abs(patch.p00), Abs(patch.p10)), Max(Abs(patch.p01), Abs(patch.p11)));
  return MaxComponent(Abs(gap)) <= kParallelogramTolerance * MaxComponent(largest);
}

bool IsRectangle(const PatchPoints& patch) {
  const auto& [p00, p10, p01, p11] = patch;
  if (p00 == p01 || p01 == p11 || p11 == p10 || p10 == p00) return false;
  const Vec3 cross = Cross(p10 - p00, p01 - p00);
  if (LengthSquared(cross) == 0 || p11 == p00) return false;
  if (AbsDot(Normalize(p11 - p00), Normalize(cross)) > 1e-5f) return false;
  const Point3 center = (p00 + p10 + p01 + p11) * 0.25f;
  const float reference = DistanceSquared(p00, center);
  for (const Point3 p : {p10, p01, p11}) {
    if (std::abs(DistanceSquared(p, center) - reference) / reference > 1e-4f) return false;
  }
  return true;
}

Point2 PatchTextureCoordinates(const BilinearMesh& mesh, uint32_t primitive, Point2 uv) {
  if (mesh.uv.empty()) return uv;
  const PatchUv st = PatchUvAt(mesh, primitive);
  return Bilinear(uv, st.uv00, st.uv10, st.uv01, st.uv11);
}

Normal3 PatchNormal(const BilinearMesh& mesh, uint32_t primitive, const PatchPoints& patch, Point2 uv) {
  Vec3 cross = PatchCross(patch, uv);
  if (LengthSquared(cross) == 0) cross = PatchCross(patch, {0.5f, 0.5f});  // a corner where two vertices meet
  Normal3 n = LengthSquared(cross) > 0 ? Normalize(cross) : Normal3{0, 0, 1};
  if (mesh.flip_normals) n = -n;
  if (mesh.N.empty()) return n;
  const PatchNormals normals = PatchNormalsAt(mesh, primitive);
  return FaceForward(n, Bilinear(uv, normals.n00, normals.n10, normals.n01, normals.n11));
}

void FillPatchInteraction(const BilinearMesh& mesh, uint32_t primitive, Point2 uv,
                          SurfaceInteraction* interaction) {
  const PatchPoints patch = PatchAt(mesh, primitive);
  interaction->p = PatchPoint(patch, uv);
  interaction->p_error = PatchPointError(patch);
  interaction->uv = PatchTextureCoordinates(mesh, primitive, uv);
  auto [dpdu, dpdv] = DifferentiatePatch(patch, uv);
  Vec3 cross = Cross(dpdu, dpdv);
  if (LengthSquared(cross) == 0) {  // a corner where two vertices meet, or no area at all
    cross = PatchCross(patch, {0.5f, 0.5f});
    if (LengthSquared(cross) == 0) cross = {0, 0, 1};
    CoordinateSystem(Normalize(cross), &dpdu, &dpdv);
  }
  const Vec3 d2pduv = (patch.p00 - patch.p01) + (patch.p11 - patch.p10);
  const NormalDerivatives dn = DifferentiateNormal(dpdu, dpdv, {}, d2pduv, {});
  ParameterDerivatives parameters;
  if (!mesh.uv.empty()) {
    parameters = DifferentiateParameters(PatchUvAt(mesh, primitive), uv);
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
  if (mesh.flip_normals) interaction->n = -interaction->n;
  interaction->shading = {interaction->n, dpdu, dpdv, parameters.ByS(dn.dndu, dn.dndv),
                          parameters.ByT(dn.dndu, dn.dndv)};
  if (!mesh.N.empty()) FillShading(mesh, primitive, uv, parameters, interaction);
}

}  // namespace tessera
