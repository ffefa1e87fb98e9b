#include "renderer/bxdf/measured_bxdf.h"

#include <algorithm>
#include <cmath>

#include "renderer/bxdf/fresnel.h"

namespace tessera {
namespace {

// Of the warp of normals at its pole, where a cell has no area.
constexpr float kSolidAngleMin = 1e-6f;

struct PolarAngles {
  float theta, phi;
};
PolarAngles AnglesOf(Vec3 w) {
  return {std::atan2(std::sqrt(w.x * w.x + w.y * w.y), w.z), std::atan2(w.y, w.x)};
}

Point2 PlaceOf(float theta, float phi) {
  return {std::sqrt(theta * (2 * kInvPi)), phi * kInv2Pi + 0.5f};
}

}  // namespace

BsdfEvaluation MeasuredBxdf::EvaluateAbove(Vec3 wo, Vec3 wi) const {
  const Vec3 m = Normalize(wo + wi);
  const PolarAngles o = AnglesOf(wo), normal = AnglesOf(m);
  Point2 u_m = PlaceOf(normal.theta, brdf_->is_isotropic ? normal.phi - o.phi : normal.phi);
  u_m.y -= std::floor(u_m.y);
  const float sigma = brdf_->sigma.Evaluate(PlaceOf(o.theta, o.phi), {});
  const WarpPoint warped = brdf_->vndf.Invert(u_m, {o.phi, o.theta});
  if (!(warped.pdf > 0 && sigma > 0)) return {};

  SampledSpectrum f;
  for (int i = 0; i < 4; ++i) {
    f.Set(i, std::max(0.0f, brdf_->spectra.Evaluate(warped.p, {o.phi, o.theta, lambda_[i]})));
  }
  f *= brdf_->ndf.Evaluate(u_m, {}) / (4 * sigma * wi.z);
  // The solid angle of normals per area of the table, then of reflected directions per normals.
  const float sin_m = std::sqrt(m.x * m.x + m.y * m.y);
  const float jacobian = 4 * Dot(wo, m) * std::max(2 * kPi * kPi * u_m.x * sin_m, kSolidAngleMin);
  return {f, brdf_->luminance.Evaluate(warped.p, {o.phi, o.theta}) * warped.pdf / jacobian};
}

BsdfEvaluation MeasuredBxdf::Evaluate(Vec3 wo, Vec3 wi) const {
  if (!SameHemisphere(wo, wi)) return {};
  return wo.z < 0 ? EvaluateAbove(-wo, -wi) : EvaluateAbove(wo, wi);
}

std::optional<BsdfSample> MeasuredBxdf::Sample(Vec3 wo, float /*uc*/, Point2 u) const {
  const Vec3 above = wo.z < 0 ? -wo : wo;
  const PolarAngles o = AnglesOf(above);
  const WarpPoint luminance = brdf_->luminance.Sample({u.y, u.x}, {o.phi, o.theta});
  const WarpPoint visible = brdf_->vndf.Sample(luminance.p, {o.phi, o.theta});
  if (!(luminance.pdf > 0 && visible.pdf > 0)) return std::nullopt;
  const float theta = visible.p.x * visible.p.x * (kPi / 2);
  const float phi = (2 * visible.p.y - 1) * kPi + (brdf_->is_isotropic ? o.phi : 0);
  const float r = std::sin(theta);
  const Vec3 wi = Reflect(above, {r * std::cos(phi), r * std::sin(phi), std::cos(theta)});
  if (!(wi.z > 0)) return std::nullopt;
  const BsdfEvaluation value = EvaluateAbove(above, wi);
  return BsdfSample{value.f, wo.z < 0 ? -wi : wi, value.pdf, BxdfFlags::kReflection | BxdfFlags::kGlossy, 1};
}

}  // namespace tessera
