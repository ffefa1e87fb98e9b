#include "renderer/bxdf/dielectric_bxdf.h"

#include <cmath>

#include "renderer/bxdf/fresnel.h"

namespace tessera {
namespace {

// The probability of reflection where the Fresnel term is `fresnel`; negative if neither lobe is possible.
float ReflectionProbability(float fresnel, Lobes lobes) {
  const float reflect = HasLobe(lobes, Lobes::kReflection) ? fresnel : 0;
  const float transmit = HasLobe(lobes, Lobes::kTransmission) ? 1 - fresnel : 0;
  const float sum = reflect + transmit;
  return sum > 0 ? reflect / sum : -1;
}

}  // namespace

BsdfEvaluation DielectricBxdf::Evaluate(Vec3 wo, Vec3 wi, TransportMode mode, Lobes lobes) const {
  if (IsSpecular() || wo.z == 0 || wi.z == 0) return {};
  const bool reflect = SameHemisphere(wo, wi);
  if (!HasLobe(lobes, reflect ? Lobes::kReflection : Lobes::kTransmission)) return {};
  const float etap = reflect ? 1 : wo.z > 0 ? eta_ : 1 / eta_;
  Vec3 m = wi * etap + wo;  // generalised half vector
  const float length2 = LengthSquared(m);
  if (length2 == 0) return {};
  m = m * ((m.z < 0 ? -1 : 1) / std::sqrt(length2));
  const float o_dot_m = Dot(wo, m), i_dot_m = Dot(wi, m);
  if (i_dot_m * wi.z < 0 || o_dot_m * wo.z < 0) return {};  // the back of a microfacet

  const float fresnel = FrDielectric(o_dot_m, eta_);
  const float p = ReflectionProbability(fresnel, lobes);
  const float d = facets_.D(m, 1);
  const float stretch_o = facets_.Stretch(wo);
  const float g = MicrofacetDistribution::G2OverCosines(wo, stretch_o, wi, facets_.Stretch(wi));
  const float visible = d / (std::abs(wo.z) + stretch_o);  // density of visible normals over 2 |wo.m|
  if (reflect) return {SampledSpectrum(0.25f * d * g * fresnel), 0.5f * visible * p};

  const float jacobian = std::abs(i_dot_m * o_dot_m) / Sqr(i_dot_m + o_dot_m / etap);
  const float scale = mode == TransportMode::kRadiance ? 1 / (etap * etap) : 1;
  return {SampledSpectrum(d * g * (1 - fresnel) * jacobian * scale), 2 * visible * jacobian * (1 - p)};
}

std::optional<BsdfSample> DielectricBxdf::SampleSpecular(Vec3 wo, float uc, TransportMode mode,
                                                         Lobes lobes) const {
  const float fresnel = FrDielectric(wo.z, eta_);
  const float p = ReflectionProbability(fresnel, lobes);
  if (p < 0) return std::nullopt;
  if (uc < p) {
    return BsdfSample{SampledSpectrum(fresnel / AbsCosTheta(wo)), Vec3{-wo.x, -wo.y, wo.z}, p,
                      BxdfFlags::kReflection | BxdfFlags::kSpecular, 1};
  }
  const Refraction refraction = Refract(wo, {0, 0, 1}, eta_);
  if (!refraction.exists || refraction.wt.z == 0) return std::nullopt;
  const float scale = mode == TransportMode::kRadiance ? 1 / Sqr(refraction.etap) : 1;
  return BsdfSample{SampledSpectrum((1 - fresnel) * scale / AbsCosTheta(refraction.wt)), refraction.wt, 1 - p,
                    BxdfFlags::kTransmission | BxdfFlags::kSpecular, refraction.etap};
}

std::optional<BsdfSample> DielectricBxdf::Sample(Vec3 wo, float uc, Point2 u, TransportMode mode,
                                                 Lobes lobes) const {
  if (wo.z == 0) return std::nullopt;
  if (IsSpecular()) return SampleSpecular(wo, uc, mode, lobes);
  const Vec3 m = facets_.SampleVisibleNormal(wo, u);
  const float p = ReflectionProbability(FrDielectric(Dot(wo, m), eta_), lobes);
  if (p < 0) return std::nullopt;
  BsdfSample sample;
  if (uc < p) {
    sample.wi = Reflect(wo, m);
    sample.flags = BxdfFlags::kReflection | BxdfFlags::kGlossy;
    if (!SameHemisphere(wo, sample.wi)) return std::nullopt;
  } else {
    const Refraction refraction = Refract(wo, m, eta_);
    sample.wi = refraction.wt;
    sample.eta = refraction.etap;
    sample.flags = BxdfFlags::kTransmission | BxdfFlags::kGlossy;
    if (!refraction.exists || !(wo.z * sample.wi.z < 0)) return std::nullopt;
  }
  const BsdfEvaluation value = Evaluate(wo, sample.wi, mode, lobes);
  if (!(value.pdf > 0)) return std::nullopt;
  sample.f = value.f;
  sample.pdf = value.pdf;
  return sample;
}

SampledSpectrum DiffuseShareOf(const DielectricBxdf& coat, Vec3 wo, Vec3 wi, SampledSpectrum f) {
  const SampledSpectrum reflected = coat.Evaluate(wo, wi, TransportMode::kRadiance, Lobes::kReflection).f;
  const SampledSpectrum share = SampledSpectrum(1.0f) - SafeDiv(reflected, f);
  return Min(Max(share, SampledSpectrum(0.0f)), SampledSpectrum(1.0f));
}

}  // namespace tessera
