#include "renderer/bxdf/layered_diffuse_bxdf.h"

#include <algorithm>

#include "renderer/bxdf/fresnel.h"
#include "renderer/bxdf/layer_walk.h"

namespace tessera {
namespace {

// Of sampling the base: keeps f / pdf bounded where the coat dominates.
constexpr float kCosineProbabilityMin = 0.1f;

struct DiffuseBase {
  static constexpr bool kMayBeMirror = false;
  SampledSpectrum reflectance;

  BaseReflection ReflectTowards(SampledSpectrum beta, Vec3 /*wo*/, Vec3 wi) const {
    const float cosine = AbsCosTheta(wi);
    return {beta * reflectance * (cosine * kInvPi), CosineHemispherePdf(cosine)};
  }
  std::optional<BaseBounce> Bounce(SampledSpectrum beta, Vec3 /*wo*/, RandomStream& random) const {
    const Vec3 w = SampleCosineHemisphere(random.Next2());
    if (w.z == 0) return std::nullopt;
    return BaseBounce{beta * reflectance, w, CosineHemispherePdf(w.z)};
  }
};

}  // namespace

SampledSpectrum LayeredDiffuseBxdf::EstimateWalk(Vec3 wo, Vec3 wi, uint64_t seed) const {
  const DiffuseBase base{reflectance_};
  return LayerWalk(coat_, base, layer_, wi, seed).Run(wo);
}

float LayeredDiffuseBxdf::CoatProbability(Vec3 wo) const {
  const float coat = FrDielectric(wo.z, coat_.eta());
  const float inner = (1 - coat) * std::max(Average(reflectance_), Average(layer_.albedo));
  return coat > 0 ? std::min(coat / (coat + inner), 1 - kCosineProbabilityMin) : 0;
}

BsdfEvaluation LayeredDiffuseBxdf::EvaluateAbove(Vec3 wo, Vec3 wi) const {
  const float coat_probability = CoatProbability(wo);
  const BsdfEvaluation coat = coat_.Evaluate(wo, wi, TransportMode::kRadiance, Lobes::kReflection);
  SampledSpectrum walks;
  const uint64_t seed = Hash(wo, wi);
  for (int i = 0; i < layer_.sample_count; ++i) walks += EstimateWalk(wo, wi, Hash(seed, i));
  return {coat.f + walks / static_cast<float>(layer_.sample_count),
          coat_probability * coat.pdf + (1 - coat_probability) * CosineHemispherePdf(wi.z)};
}

BsdfEvaluation LayeredDiffuseBxdf::Evaluate(Vec3 wo, Vec3 wi) const {
  if (!SameHemisphere(wo, wi)) return {};
  return wo.z < 0 ? EvaluateAbove(-wo, -wi) : EvaluateAbove(wo, wi);
}

std::optional<BsdfSample> LayeredDiffuseBxdf::SampleAbove(Vec3 wo, float uc, Point2 u) const {
  const float coat_probability = CoatProbability(wo);
  BsdfSample sample;
  if (uc < coat_probability) {
    const auto coat = coat_.Sample(wo, 0, u, TransportMode::kRadiance, Lobes::kReflection);
    if (!coat) return std::nullopt;
    sample = *coat;
    if (coat->IsSpecular()) {
      sample.pdf = coat_probability;
      return sample;
    }
  } else {
    sample.wi = SampleCosineHemisphere(u);
    if (!(sample.wi.z > 0)) return std::nullopt;
    sample.flags = BxdfFlags::kReflection | BxdfFlags::kDiffuse;
  }
  const BsdfEvaluation value = EvaluateAbove(wo, sample.wi);
  sample.f = value.f;
  sample.pdf = value.pdf;
  return sample;
}

SampledSpectrum LayeredDiffuseBxdf::DiffuseShare(Vec3 wo, Vec3 wi) const {
  if (wo.z < 0) return DiffuseShare(-wo, -wi);
  return DiffuseShareOf(coat_, wo, wi, Evaluate(wo, wi).f);
}

std::optional<BsdfSample> LayeredDiffuseBxdf::Sample(Vec3 wo, float uc, Point2 u) const {
  if (wo.z > 0) return SampleAbove(wo, uc, u);
  std::optional<BsdfSample> sample = SampleAbove(-wo, uc, u);
  if (sample) sample->wi = -sample->wi;
  return sample;
}

}  // namespace tessera
