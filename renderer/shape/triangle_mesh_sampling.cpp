#include <algorithm>

#include "renderer/math/sampling.h"
#include "renderer/shape/solid_angle_density.h"
#include "renderer/shape/triangle_mesh.h"

namespace tessera {
namespace {

// Solid angles in steradians outside which spherical sampling is not accurate.
constexpr float kSphericalAreaMin = 3e-4f, kSphericalAreaMax = 6.22f;

// Whether the solid angle is below kSphericalAreaMin, by a bound that is cheap: no point of the triangle is
// nearer than half the distance of a corner that is more than two edges away.
bool IsSurelySmall(const TrianglePoints& triangle, Point3 p) {
  const Vec3 e1 = triangle.p1 - triangle.p0, e2 = triangle.p2 - triangle.p0;
  const float edge_squared = std::max(LengthSquared(e1), LengthSquared(e2));
  const float distance_squared = LengthSquared(triangle.p0 - p);
  const float twice_area_max = std::sqrt(LengthSquared(e1) * LengthSquared(e2));
  return distance_squared > 4 * edge_squared && 2 * twice_area_max < kSphericalAreaMin * distance_squared;
}

// As seen from p; nullopt if it is to be sampled by area.
std::optional<SphericalTriangle> SphereSeenFrom(Point3 p, const TrianglePoints& triangle) {
  std::optional<SphericalTriangle> spherical;
  if (IsSurelySmall(triangle, p)) return spherical;
  spherical.emplace(triangle, p);
  if (!(spherical->area() >= kSphericalAreaMin && spherical->area() <= kSphericalAreaMax)) spherical.reset();
  return spherical;
}

ShapeSample SampleAt(const TriangleMesh& mesh, uint32_t primitive, const TrianglePoints& triangle, float u,
                     float v, bool needs_uv) {
  ShapeSample sample;
  sample.p = TrianglePoint(triangle, u, v);
  sample.p_error = TrianglePointError(triangle, u, v);
  sample.n = mesh.Normal(primitive, triangle, u, v);
  if (needs_uv) sample.uv = mesh.TextureCoordinates(primitive, u, v);
  return sample;
}

std::optional<ShapeSample> SampleByArea(const TriangleMesh& mesh, uint32_t primitive,
                                        const TrianglePoints& triangle, const ReferencePoint& reference,
                                        Point2 u, bool needs_uv) {
  const Vec3 b = SampleUniformTriangle(u);
  ShapeSample sample = SampleAt(mesh, primitive, triangle, b.y, b.z, needs_uv);
  sample.pdf = 1 / TriangleArea(triangle);
  return SeenFrom(reference, sample);
}

// How the warp weighs the unit square that spherical sampling starts from: its lower edge is corner 1, its
// upper corners are 0 and 2.
BilinearWeights Warp(const TrianglePoints& triangle, const ReferencePoint& reference) {
  const float w1 = CornerWeight(reference, triangle.p1);
  return {w1, w1, CornerWeight(reference, triangle.p0), CornerWeight(reference, triangle.p2)};
}

}  // namespace

std::optional<ShapeSample> TriangleMesh::Sample(uint32_t primitive, const ReferencePoint& reference, Point2 u,
                                                bool needs_uv) const {
  const TrianglePoints triangle = At(primitive);
  const std::optional<SphericalTriangle> spherical = SphereSeenFrom(reference.p, triangle);
  if (!spherical) return SampleByArea(*this, primitive, triangle, reference, u, needs_uv);
  float pdf = 1 / spherical->area();
  if (IsOnSurface(reference)) {
    const BilinearWeights weights = Warp(triangle, reference);
    u = SampleBilinear(u, weights);
    pdf *= BilinearPdf(u, weights);
  }
  TriangleCrossing crossing;
  if (!CrossTriangle(triangle, {Double3(reference.p), spherical->Sample(u)}, &crossing)) return std::nullopt;
  const double b1 = std::clamp(crossing.u, 0.0, 1.0);
  const double b2 = std::clamp(crossing.v, 0.0, 1 - b1);
  ShapeSample sample =
      SampleAt(*this, primitive, triangle, static_cast<float>(b1), static_cast<float>(b2), needs_uv);
  sample.pdf = pdf;
  return sample;
}

float TriangleMesh::Pdf(uint32_t primitive, const ReferencePoint& reference, Vec3 wi,
                        const SurfaceInteraction& on_light) const {
  const TrianglePoints triangle = At(primitive);
  const std::optional<SphericalTriangle> spherical = SphereSeenFrom(reference.p, triangle);
  if (!spherical) return PerSolidAngle(1 / TriangleArea(triangle), reference.p, on_light.p, on_light.n);
  const float pdf = 1 / spherical->area();
  if (!IsOnSurface(reference)) return pdf;
  return pdf * BilinearPdf(spherical->Invert(wi), Warp(triangle, reference));
}

NormalCone TriangleMesh::Normals(uint32_t primitive) const {
  // If the mesh has normals, the mean of the three decides the side, as in pbrt.
  constexpr float kThird = 1.0f / 3;
  return {Normal(primitive, At(primitive), kThird, kThird), 1};
}

}  // namespace tessera
