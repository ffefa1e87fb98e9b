#include "renderer/shape/patch_sampling.h"

#include "renderer/shape/solid_angle_density.h"

namespace tessera {
namespace {

// Below this solid angle, in steradians, a rectangle is sampled by area: the spherical map loses its
// precision.
constexpr float kSphericalAreaMin = 1e-3f;

SphericalRectangle RectangleSeenFrom(const PatchPoints& patch, Point3 p) {
  return {p, patch.p00, patch.p10 - patch.p00, patch.p01 - patch.p00};
}

// A plane lights no point of itself. Rounding puts such points a little off it, from where it would seem to
// fill half of all directions.
bool IsInPlaneOf(const PatchPoints& patch, const ReferencePoint& reference) {
  const Vec3 n = Normalize(Cross(patch.p10 - patch.p00, patch.p01 - patch.p00));
  const float error = Dot(Abs(n), reference.p_error + PatchPointError(patch));
  return std::abs(Dot(n, reference.p - patch.p00)) <= error;
}

BilinearWeights CosineWarp(const PatchPoints& patch, const ReferencePoint& reference) {
  return {CornerWeight(reference, patch.p00), CornerWeight(reference, patch.p10),
          CornerWeight(reference, patch.p01), CornerWeight(reference, patch.p11)};
}

// Area per parameter area at the corners.
BilinearWeights CornerAreas(const PatchPoints& patch) {
  const Vec3 bottom = patch.p10 - patch.p00, top = patch.p11 - patch.p01;
  const Vec3 left = patch.p01 - patch.p00, right = patch.p11 - patch.p10;
  return {Length(Cross(bottom, left)), Length(Cross(bottom, right)), Length(Cross(left, top)),
          Length(Cross(right, top))};
}

// Per area, of area sampling.
float AreaPdf(const PatchPoints& patch, bool is_rectangle, Point2 uv) {
  const float pdf = is_rectangle ? 1 : BilinearPdf(uv, CornerAreas(patch));
  return pdf / Length(PatchCross(patch, uv));
}

ShapeSample SampleAt(const BilinearMesh& mesh, uint32_t primitive, const PatchPoints& patch, Point2 uv) {
  ShapeSample sample;
  sample.p = PatchPoint(patch, uv);
  sample.p_error = PatchPointError(patch);
  sample.n = PatchNormal(mesh, primitive, patch, uv);
  sample.uv = PatchTextureCoordinates(mesh, primitive, uv);
  return sample;
}

}  // namespace

std::optional<ShapeSample> SamplePatch(const BilinearMesh& mesh, uint32_t primitive,
                                       const ReferencePoint& reference, Point2 u) {
  const PatchPoints patch = PatchAt(mesh, primitive);
  const bool is_rectangle = IsRectangle(patch);
  if (is_rectangle) {
    if (IsInPlaneOf(patch, reference)) return std::nullopt;
    const SphericalRectangle spherical = RectangleSeenFrom(patch, reference.p);
    if (spherical.area() >= kSphericalAreaMin) {
      float pdf = 1 / spherical.area();
      if (IsOnSurface(reference)) {
        const BilinearWeights weights = CosineWarp(patch, reference);
        u = SampleBilinear(u, weights);
        pdf *= BilinearPdf(u, weights);
      }
      ShapeSample sample = SampleAt(mesh, primitive, patch, spherical.Sample(u));
      sample.pdf = pdf;
      return sample;
    }
  }
  const Point2 uv = is_rectangle ? u : SampleBilinear(u, CornerAreas(patch));
  ShapeSample sample = SampleAt(mesh, primitive, patch, uv);
  sample.pdf = AreaPdf(patch, is_rectangle, uv);
  return SeenFrom(reference, sample);
}

float PatchPdf(const BilinearMesh& mesh, uint32_t primitive, const ReferencePoint& reference,
               const SurfaceInteraction& on_light) {
  const PatchPoints patch = PatchAt(mesh, primitive);
  const bool is_rectangle = IsRectangle(patch);
  if (is_rectangle) {
    if (IsInPlaneOf(patch, reference)) return 0;
    const SphericalRectangle spherical = RectangleSeenFrom(patch, reference.p);
    if (spherical.area() >= kSphericalAreaMin) {
      const float pdf = 1 / spherical.area();
      if (!IsOnSurface(reference)) return pdf;
      const Point2 place = InvertPatch(patch, on_light.p);
      return pdf * BilinearPdf(spherical.Invert(place), CosineWarp(patch, reference));
    }
  }
  const Point2 uv = mesh.uv.empty() ? on_light.uv : InvertPatch(patch, on_light.p);
  return PerSolidAngle(AreaPdf(patch, is_rectangle, uv), reference.p, on_light.p, on_light.n);
}

float PatchArea(const PatchPoints& patch) {
  if (IsRectangle(patch)) return Distance(patch.p00, patch.p01) * Distance(patch.p00, patch.p10);
  // Midpoint rule; the integrand is a square root of a polynomial of degree 4, smooth but for degenerate
  // patches.
  constexpr int kSteps = 8;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j)
      sum += Length(PatchCross(patch, {(i + 0.5f) / kSteps, (j + 0.5f) / kSteps}));
  }
  return static_cast<float>(sum / (kSteps * kSteps));
}

NormalCone PatchNormals(const BilinearMesh& mesh, uint32_t primitive) {
  const PatchPoints patch = PatchAt(mesh, primitive);
  const Normal3 corners[4] = {
      PatchNormal(mesh, primitive, patch, {0, 0}), PatchNormal(mesh, primitive, patch, {1, 0}),
      PatchNormal(mesh, primitive, patch, {0, 1}), PatchNormal(mesh, primitive, patch, {1, 1})};
  const Vec3 sum = corners[0] + corners[1] + corners[2] + corners[3];
  if (LengthSquared(sum) == 0) return {};
  NormalCone cone{Normalize(sum), 1};
  for (const Normal3 n : corners) cone.cos_angle = std::min(cone.cos_angle, Dot(cone.axis, n));
  cone.cos_angle = std::max(cone.cos_angle, -1.0f);
  return cone;
}

Point2 InvertPatch(const PatchPoints& patch, Point3 p) {
  constexpr int kIterations = 12;
  constexpr double kSmallStep = 1e-9;
  const Double3 p00(patch.p00), e10 = Difference(patch.p10, patch.p00),
                                e01 = Difference(patch.p01, patch.p00);
  const Double3 twist = Difference(patch.p11, patch.p10) - e01;
  double u = 0.5, v = 0.5;
  for (int i = 0; i < kIterations; ++i) {
    const Double3 by_u = e10 + twist * v, by_v = e01 + twist * u;
    const Double3 residual = p00 + e10 * u + e01 * v + twist * (u * v) - Double3(p);
    const double uu = Dot(by_u, by_u), uv = Dot(by_u, by_v), vv = Dot(by_v, by_v);
    const double determinant = uu * vv - uv * uv;
    if (!(determinant > 0)) break;
    const double ru = Dot(by_u, residual), rv = Dot(by_v, residual);
    const double du = (vv * ru - uv * rv) / determinant, dv = (uu * rv - uv * ru) / determinant;
    u -= du;
    v -= dv;
    if (std::abs(du) < kSmallStep && std::abs(dv) < kSmallStep) break;
  }
  return {static_cast<float>(std::clamp(u, 0.0, 1.0)), static_cast<float>(std::clamp(v, 0.0, 1.0))};
}

}  // namespace tessera
