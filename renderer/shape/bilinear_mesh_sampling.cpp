#include "renderer/shape/bilinear_mesh.h"
#include "renderer/shape/solid_angle_density.h"

namespace tessera {
namespace {

// Below this solid angle, in steradians, a rectangle is sampled by area: the spherical map loses its
// precision.
constexpr float kSphericalAreaMin = 1e-3f;

SphericalRectangle RectangleSeenFrom(const PatchPoints& patch, Point3 p) {
  return {p, patch.p00, patch.p10 - patch.p00, patch.p01 - patch.p00};
}

// A plane lights no point of itself. Rounding moves such points slightly off it, where it would appear to
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
  sample.n = mesh.Normal(primitive, patch, uv);
  sample.uv = mesh.TextureCoordinates(primitive, uv);
  return sample;
}

}  // namespace

std::optional<ShapeSample> BilinearMesh::Sample(uint32_t primitive, const ReferencePoint& reference,
                                                Point2 u, bool /*needs_uv*/) const {
  const PatchPoints patch = At(primitive);
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
      ShapeSample sample = SampleAt(*this, primitive, patch, spherical.Sample(u));
      sample.pdf = pdf;
      return sample;
    }
  }
  const Point2 place = is_rectangle ? u : SampleBilinear(u, CornerAreas(patch));
  ShapeSample sample = SampleAt(*this, primitive, patch, place);
  sample.pdf = AreaPdf(patch, is_rectangle, place);
  return SeenFrom(reference, sample);
}

float BilinearMesh::Pdf(uint32_t primitive, const ReferencePoint& reference, Vec3,
                        const SurfaceInteraction& on_light) const {
  const PatchPoints patch = At(primitive);
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
  const Point2 place = uv.empty() ? on_light.uv : InvertPatch(patch, on_light.p);
  return PerSolidAngle(AreaPdf(patch, is_rectangle, place), reference.p, on_light.p, on_light.n);
}

NormalCone BilinearMesh::Normals(uint32_t primitive) const {
  const PatchPoints patch = At(primitive);
  const Normal3 corners[4] = {Normal(primitive, patch, {0, 0}), Normal(primitive, patch, {1, 0}),
                              Normal(primitive, patch, {0, 1}), Normal(primitive, patch, {1, 1})};
  const Vec3 sum = corners[0] + corners[1] + corners[2] + corners[3];
  if (LengthSquared(sum) == 0) return {};
  NormalCone cone{Normalize(sum), 1};
  for (const Normal3 n : corners) cone.cos_angle = std::min(cone.cos_angle, Dot(cone.axis, n));
  cone.cos_angle = std::max(cone.cos_angle, -1.0f);
  return cone;
}

}  // namespace tessera
