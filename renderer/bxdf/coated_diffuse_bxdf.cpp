#include "renderer/bxdf/coated_diffuse_bxdf.h"

#include "renderer/bxdf/fresnel.h"
#include "renderer/math/sampling.h"

namespace tessera {
namespace {

// q^n by repeated squaring.
SampledSpectrum Power(SampledSpectrum q, int n) {
  SampledSpectrum result(1.0f);
  for (; n > 0; n >>= 1) {
    if (n & 1) result *= q;
    q *= q;
  }
  return result;
}

constexpr BxdfFlags kCoatSpecular = BxdfFlags::kReflection | BxdfFlags::kSpecular;

}  // namespace

CoatedDiffuseBxdf::CoatedDiffuseBxdf(const DielectricBxdf& coat, const CoatLookup& lookup,
                                     SampledSpectrum reflectance, int base_hits)
    : coat_(coat), lookup_(lookup) {
  const SampledSpectrum q = reflectance * lookup.internal_reflectance();
  const SampledSpectrum hits = SafeDiv(1.0f - Power(q, base_hits), 1.0f - q);
  base_ = reflectance * hits * (kInvPi / Sqr(coat.eta()));
  base_albedo_ = Average(base_) * kPi * lookup.mean_transmittance();
}

CoatedDiffuseBxdf::Choice CoatedDiffuseBxdf::ChoiceAt(float cos_o) const {
  const CoatAngle angle = lookup_.At(cos_o);
  const float sum = angle.reflectance + angle.transmittance * base_albedo_;
  return {angle.transmittance, sum > 0 ? angle.reflectance / sum : 0};
}

BsdfEvaluation CoatedDiffuseBxdf::EvaluateAbove(Vec3 wo, Vec3 wi, const Choice& choice,
                                                float transmittance_i) const {
  BsdfEvaluation result{base_ * (choice.transmittance * transmittance_i),
                        (1 - choice.coat_probability) * CosineHemispherePdf(wi.z)};
  if (coat_.IsSpecular()) return result;
  const MicrofacetDistribution& facets = coat_.facets();
  const Vec3 h = wo + wi;
  const float length2 = LengthSquared(h);
  const float d = facets.D(h, length2);
  const float stretch_o = facets.Stretch(wo);
  const float g = MicrofacetDistribution::G2OverCosines(wo, stretch_o, wi, facets.Stretch(wi));
  const float fresnel = FrDielectric(0.5f * std::sqrt(length2), coat_.eta());
  result.f += SampledSpectrum(0.25f * d * g * fresnel);
  result.pdf += choice.coat_probability * facets.ReflectionPdf(wo, d, stretch_o);
  return result;
}

BsdfEvaluation CoatedDiffuseBxdf::Evaluate(Vec3 wo, Vec3 wi) const {
  if (!SameHemisphere(wo, wi)) return {};
  if (wo.z < 0) {
    wo = -wo;
    wi = -wi;
  }
  return EvaluateAbove(wo, wi, ChoiceAt(wo.z), lookup_.At(wi.z).transmittance);
}

std::optional<BsdfSample> CoatedDiffuseBxdf::SampleAbove(Vec3 wo, float uc, Point2 u) const {
  const Choice choice = ChoiceAt(wo.z);
  if (!(uc < choice.coat_probability)) {
    const Vec3 wi = SampleCosineHemisphere(u);
    if (!(wi.z > 0)) return std::nullopt;
    const BsdfEvaluation value = EvaluateAbove(wo, wi, choice, lookup_.At(wi.z).transmittance);
    return BsdfSample{value.f, wi, value.pdf, BxdfFlags::kReflection | BxdfFlags::kDiffuse, 1};
  }
  if (coat_.IsSpecular()) {
    const SampledSpectrum f(FrDielectric(wo.z, coat_.eta()) / wo.z);
    return BsdfSample{f, Vec3{-wo.x, -wo.y, wo.z}, choice.coat_probability, kCoatSpecular, 1};
  }
  const Vec3 wi = Reflect(wo, coat_.facets().SampleReflectingNormal(wo, u));
  if (!(wi.z > 0)) return std::nullopt;
  const BsdfEvaluation value = EvaluateAbove(wo, wi, choice, lookup_.At(wi.z).transmittance);
  return BsdfSample{value.f, wi, value.pdf, BxdfFlags::kReflection | BxdfFlags::kGlossy, 1};
}

SampledSpectrum CoatedDiffuseBxdf::DiffuseShare(Vec3 wo, Vec3 wi) const {
  if (wo.z < 0) return DiffuseShare(-wo, -wi);
  return DiffuseShareOf(coat_, wo, wi, Evaluate(wo, wi).f);
}

std::optional<BsdfSample> CoatedDiffuseBxdf::Sample(Vec3 wo, float uc, Point2 u) const {
  if (wo.z > 0) return SampleAbove(wo, uc, u);
  std::optional<BsdfSample> sample = SampleAbove(-wo, uc, u);
  if (sample) sample->wi = -sample->wi;
  return sample;
}

}  // namespace tessera
