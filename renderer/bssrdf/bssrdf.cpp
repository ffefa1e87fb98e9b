#include "renderer/bssrdf/bssrdf.h"

#include <cmath>

namespace tessera {
namespace {

constexpr float kRadiusQuantile = 0.999f;
// Light that is spread farther is lost; keeps the squares of radii finite.
constexpr float kRadiusMax = 1e18f;
// With which probes go along the tangents and the normal.
constexpr float kTangentProbability = 0.25f, kNormalProbability = 0.5f;

}  // namespace

Bssrdf::Bssrdf(const DiffusionProfile& profile, Point3 po, Normal3 ns, SampledSpectrum sigma_a,
               SampledSpectrum sigma_s)
    : profile_(&profile), po_(po), frame_(Frame::FromZ(ns)), sigma_t_(sigma_a + sigma_s) {
  const SampledSpectrum albedo = SafeDiv(sigma_s, sigma_t_);
  for (int i = 0; i < 4; ++i) {
    albedo_[static_cast<size_t>(i)] = profile.PlaceOf(albedo[i]);
    effective_.Set(i, profile.EffectiveAlbedo(albedo_[static_cast<size_t>(i)]));
  }
  const float sigma_t = sigma_t_[0];
  if (!(sigma_t > 0)) return;
  const std::optional<float> radius = profile.SampleRadius(albedo_[0], kRadiusQuantile);
  if (radius && *radius / sigma_t <= kRadiusMax) radius_max_ = *radius / sigma_t;
}

std::optional<ProbeSegment> Bssrdf::SampleProbe(float u_axis, Point2 u) const {
  if (!(radius_max_ > 0)) return std::nullopt;
  const std::optional<float> optical = profile_->SampleRadius(albedo_[0], u.x);
  if (!optical) return std::nullopt;
  const float radius = *optical / sigma_t_[0];
  if (!(radius < radius_max_)) return std::nullopt;
  // In local coordinates: the axis of the probe, and the two across it.
  const int axis = u_axis < kTangentProbability ? 0 : u_axis < 2 * kTangentProbability ? 1 : 2;
  const float phi = 2 * kPi * u.y;
  const float a = radius * std::cos(phi), b = radius * std::sin(phi);
  const float half = std::sqrt(radius_max_ * radius_max_ - radius * radius);
  Vec3 from, along;
  if (axis == 0) from = {-half, a, b}, along = {2 * half, 0, 0};
  if (axis == 1) from = {a, -half, b}, along = {0, 2 * half, 0};
  if (axis == 2) from = {a, b, -half}, along = {0, 0, 2 * half};
  return ProbeSegment{po_ + frame_.FromLocal(from), frame_.FromLocal(along)};
}

SampledSpectrum Bssrdf::EvaluateRadius(float radius) const {
  SampledSpectrum value;
  for (int i = 0; i < 4; ++i)
    value.Set(i, profile_->Evaluate(albedo_[static_cast<size_t>(i)], radius * sigma_t_[i]));
  return value * sigma_t_ * sigma_t_;
}

SampledSpectrum Bssrdf::Pdf(Point3 p, Normal3 n) const {
  const Vec3 d = frame_.ToLocal(p - po_), local_n = frame_.ToLocal(n);
  const auto along = [&](float x, float y, float cosine) {
    return EvaluateRadius(std::sqrt(x * x + y * y)) * std::abs(cosine);
  };
  const SampledSpectrum tangents = along(d.y, d.z, local_n.x) + along(d.z, d.x, local_n.y);
  const SampledSpectrum normal = along(d.x, d.y, local_n.z);
  return SafeDiv(tangents * kTangentProbability + normal * kNormalProbability, effective_);
}

}  // namespace tessera
