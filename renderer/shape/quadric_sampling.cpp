#include <algorithm>
#include <cmath>

#include "renderer/math/float4.h"
#include "renderer/math/sampling.h"
#include "renderer/shape/quadric.h"
#include "renderer/shape/shading_geometry.h"
#include "renderer/shape/solid_angle_density.h"

namespace tessera {
namespace {

// The sphere that a quadric is in rendering space, if it is a whole one and its transform does not stretch
// it.
struct RenderSphere {
  Point3 center;
  float radius = 0;
};

std::optional<RenderSphere> AsRenderSphere(const Quadric& q) {
  constexpr float kTolerance = 1e-5f;  // relative, of the squared scale and of orthogonality
  if (q.kind != Quadric::Kind::kSphere || q.phi_max < 2 * kPi || q.z_min > -q.radius || q.z_max < q.radius)
    return {};
  // One lane for each column of the linear part: its square, and its product with the next column.
  const auto& m = q.render_from_object.matrix().m;
  Float4 squares, products;
  for (int i = 0; i < 3; ++i) {
    const Float4 row(_mm_setr_ps(m[i][0], m[i][1], m[i][2], 0));
    squares += row * row;
    products += row * Float4(_mm_permute_ps(row.v, _MM_SHUFFLE(3, 0, 2, 1)));
  }
  const float scale = squares[0];
  const Float4 differences = Float4(_mm_blend_ps((squares - Float4(scale)).v, _mm_setzero_ps(), 8));
  const Float4 errors = Max(Abs(differences), Abs(products));
  if (!(MaxElement(errors) <= kTolerance * scale)) return {};
  const float w = m[3][3];
  const Point3 center{m[0][3], m[1][3], m[2][3]};
  return RenderSphere{w == 1 ? center : center / w, q.radius * std::sqrt(scale)};
}

bool IsOutside(const RenderSphere& sphere, const ReferencePoint& reference) {
  const float distance_squared = DistanceSquared(reference.p, sphere.center);
  // Well over the length of the offset, which is at most half the diagonal of the box of errors.
  const float offset_max = 2 * (reference.p_error.x + reference.p_error.y + reference.p_error.z);
  constexpr float kRounding = 1.0001f;
  if (distance_squared > Sqr(kRounding * (sphere.radius + offset_max))) return true;
  const Point3 origin =
      OffsetRayOrigin(reference.p, reference.p_error, reference.n, sphere.center - reference.p);
  return DistanceSquared(origin, sphere.center) > Sqr(sphere.radius);
}

// The cone of directions in which a sphere lies.
struct SphereCone {
  float sin2_theta_max, one_minus_cos_theta_max;
  bool is_narrow;  // below 1.5 degrees the cosine loses its digits

  SphereCone(const RenderSphere& sphere, Point3 p)
      : sin2_theta_max(std::min(1.0f, Sqr(sphere.radius) / DistanceSquared(p, sphere.center))),
        one_minus_cos_theta_max(sin2_theta_max / (1 + std::sqrt(1 - sin2_theta_max))),
        is_narrow(sin2_theta_max < 0.00068523f) {}
  float Pdf() const { return 1 / (2 * kPi * one_minus_cos_theta_max); }
};

std::optional<ShapeSample> SampleCone(const Quadric& quadric, const RenderSphere& sphere,
                                      const ReferencePoint& reference, Point2 u, bool needs_uv) {
  const SphereCone cone(sphere, reference.p);
  float cos_theta = 1 - cone.one_minus_cos_theta_max * u.x;
  float sin2_theta = 1 - cos_theta * cos_theta;
  if (cone.is_narrow) {
    sin2_theta = cone.sin2_theta_max * u.x;
    cos_theta = std::sqrt(1 - sin2_theta);
  }
  // alpha: the angle, at the sphere's centre, between the sampled point and the reference point.
  const float sin_theta_max = std::sqrt(cone.sin2_theta_max);
  const float cos_alpha =
      sin2_theta / sin_theta_max + cos_theta * SafeSqrt(1 - sin2_theta / cone.sin2_theta_max);
  const float sin_alpha = SafeSqrt(1 - Sqr(cos_alpha));
  const float phi = u.y * 2 * kPi;
  const Frame frame = Frame::FromZ(Normalize(sphere.center - reference.p));
  const Vec3 outward = -frame.FromLocal({sin_alpha * std::cos(phi), sin_alpha * std::sin(phi), cos_alpha});
  const Double3 object_normal =
      TransformVector(quadric.render_from_object.inverse_matrix(), Double3(outward));
  const Double3 p_object = ProjectToQuadric(quadric, object_normal);
  const Point3 p = p_object.ToFloat();
  const PointWithError point =
      TransformPointWithError(quadric.render_from_object, p_object, QuadricPointError(quadric, p));
  ShapeSample sample;
  sample.p = point.p;
  sample.p_error = point.error;
  sample.n = QuadricNormal(quadric, p);
  if (needs_uv) sample.uv = QuadricUv(quadric, p);
  sample.pdf = cone.Pdf();
  if (!std::isfinite(sample.pdf)) return std::nullopt;
  return sample;
}

float ObjectArea(const Quadric& q) {
  if (q.kind == Quadric::Kind::kDisk) return q.phi_max * 0.5f * (Sqr(q.radius) - Sqr(q.inner_radius));
  return q.phi_max * q.radius * (q.z_max - q.z_min);
}

// Uniform over the area, in object space.
Point3 SampleObjectPoint(const Quadric& q, Point2 u) {
  if (q.kind == Quadric::Kind::kDisk && q.inner_radius == 0 && q.phi_max >= 2 * kPi) {
    const Point2 d = SampleUniformDiskConcentric(u);
    return {d.x * q.radius, d.y * q.radius, q.z_min};
  }
  const float phi = u.y * q.phi_max;
  float r = q.radius;
  float z = q.z_min;
  if (q.kind == Quadric::Kind::kDisk) {
    r = std::sqrt(Lerp(u.x, Sqr(q.inner_radius), Sqr(q.radius)));
  } else {
    z = Lerp(u.x, q.z_min, q.z_max);
    if (q.kind == Quadric::Kind::kSphere) r = SafeSqrt(Sqr(q.radius) - z * z);
  }
  return {r * std::cos(phi), r * std::sin(phi), z};
}

// Rendering-space area per object-space area where the rendering-space unit normal is n.
float AreaScale(const Quadric& quadric, Normal3 n) {
  // The object-space normal is parallel to M^T n, and area scales with |det M| |M^-T n_object|.
  const auto& m = quadric.render_from_object.matrix().m;
  const Vec3 x{m[0][0], m[1][0], m[2][0]}, y{m[0][1], m[1][1], m[2][1]}, z{m[0][2], m[1][2], m[2][2]};
  const float determinant = std::abs(Dot(x, Cross(y, z)));
  return determinant / Length({Dot(x, n), Dot(y, n), Dot(z, n)});
}

std::optional<ShapeSample> SampleByArea(const Quadric& quadric, const ReferencePoint& reference, Point2 u,
                                        bool needs_uv) {
  const Double3 exact = ProjectToQuadric(quadric, Double3(SampleObjectPoint(quadric, u)));
  const Point3 p = exact.ToFloat();
  const PointWithError point =
      TransformPointWithError(quadric.render_from_object, exact, QuadricPointError(quadric, p));
  ShapeSample sample;
  sample.p = point.p;
  sample.p_error = point.error;
  sample.n = QuadricNormal(quadric, p);
  if (needs_uv) sample.uv = QuadricUv(quadric, p);
  sample.pdf = 1 / (ObjectArea(quadric) * AreaScale(quadric, sample.n));
  return SeenFrom(reference, sample);
}

}  // namespace

std::optional<ShapeSample> Quadric::Sample(uint32_t, const ReferencePoint& reference, Point2 u,
                                           bool needs_uv) const {
  const std::optional<RenderSphere> sphere = AsRenderSphere(*this);
  if (sphere && IsOutside(*sphere, reference)) return SampleCone(*this, *sphere, reference, u, needs_uv);
  return SampleByArea(*this, reference, u, needs_uv);
}

float Quadric::Pdf(uint32_t, const ReferencePoint& reference, Vec3 wi,
                   const SurfaceInteraction& on_light) const {
  const std::optional<RenderSphere> sphere = AsRenderSphere(*this);
  if (sphere && IsOutside(*sphere, reference)) {
    const Normal3 outward = flip_normals ? -on_light.n : on_light.n;
    if (Dot(outward, wi) > 0) return 0;  // the far side, which a ray reaches that passes the near one
    const float pdf = SphereCone(*sphere, reference.p).Pdf();
    return std::isfinite(pdf) ? pdf : 0;
  }
  const float pdf = 1 / (ObjectArea(*this) * AreaScale(*this, on_light.n));
  return PerSolidAngle(pdf, reference.p, on_light.p, on_light.n);
}

float Quadric::Area(uint32_t) const {
  const float object_area = ObjectArea(*this);
  if (const std::optional<RenderSphere> sphere = AsRenderSphere(*this)) return 4 * kPi * Sqr(sphere->radius);
  if (kind == Kind::kDisk) return object_area * AreaScale(*this, QuadricNormal(*this, {}));
  constexpr int kSteps = 32;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const Point3 p = SampleObjectPoint(*this, {(i + 0.5f) / kSteps, (j + 0.5f) / kSteps});
      sum += AreaScale(*this, QuadricNormal(*this, p));
    }
  }
  return object_area * static_cast<float>(sum / (kSteps * kSteps));
}

NormalCone Quadric::Normals(uint32_t) const {
  if (kind != Kind::kDisk) return {};
  return {QuadricNormal(*this, {}), 1};
}

}  // namespace tessera
