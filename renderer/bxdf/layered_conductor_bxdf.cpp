#include "renderer/bxdf/layered_conductor_bxdf.h"

#include <algorithm>
#include <limits>

#include "renderer/bxdf/conductor_bxdf.h"
#include "renderer/bxdf/fresnel.h"
#include "renderer/bxdf/layer_walk.h"

namespace tessera {
namespace {

// Of sampling the cosine lobe: keeps f / pdf bounded where light is reflected several times.
constexpr float kDiffuseProbabilityMin = 0.2f;
// The least width of the metal's lobe under a rough coat.
constexpr float kMetalAlphaMin = 2 * MicrofacetDistribution::kAlphaSmooth;

class ConductorBase {
 public:
  static constexpr bool kMayBeMirror = true;

  ConductorBase(const MicrofacetDistribution& facets, SampledSpectrum eta, SampledSpectrum k)
      : metal_(facets, eta, k), is_mirror_(facets.IsSmooth()) {}

  SampledSpectrum MirrorReflectance(float cos_theta) const {
    if (!is_mirror_) return SampledSpectrum(0.0f);
    return metal_.Fresnel(cos_theta);
  }

  BaseReflection ReflectTowards(SampledSpectrum beta, Vec3 wo, Vec3 wi) const {
    const BsdfEvaluation value = metal_.Evaluate(wo, wi);
    return {beta * value.f * AbsCosTheta(wi), value.pdf};
  }
  std::optional<BaseBounce> Bounce(SampledSpectrum beta, Vec3 wo, RandomStream& random) const {
    const auto sample = metal_.Sample(wo, 0, random.Next2());
    if (!sample || sample->wi.z == 0 || !(sample->pdf > 0)) return std::nullopt;
    return BaseBounce{beta * sample->f * (AbsCosTheta(sample->wi) / sample->pdf), sample->wi,
                      sample->IsSpecular() ? std::numeric_limits<float>::infinity() : sample->pdf};
  }

 private:
  ConductorBxdf metal_;
  bool is_mirror_;
};

// A direction above a smooth interface and its refraction below, both pointing upwards. eta: below over
// above.
struct Refracted {
  bool exists = false;
  Vec3 below;
};
Refracted RefractBelow(Vec3 above, float eta) {
  const float x = above.x / eta, y = above.y / eta;
  const float cos2 = 1 - x * x - y * y;
  if (!(cos2 > 0)) return {};
  return {true, {x, y, std::sqrt(cos2)}};
}

// The metal as it looks through the coat, for sampling: light is refracted as by a smooth coat, and the metal
// is made rougher by what two passages through the rough coat spread light. The slopes of a coat of width
// alpha bend light by (eta - 1) / eta of their own size, those of the metal by twice their size.
class MetalLobe {
 public:
  MetalLobe(const DielectricBxdf& coat, const MicrofacetDistribution& metal, Vec3 wo)
      : eta_(coat.eta()), wo_(RefractBelow(wo, coat.eta())) {
    if (coat.IsSpecular()) {
      facets_ = metal;
      return;
    }
    const float spread = Sqr((eta_ - 1) / eta_) / 2;
    const auto width = [&](float alpha_metal, float alpha_coat) {
      return std::max(kMetalAlphaMin, std::sqrt(Sqr(alpha_metal) + spread * Sqr(alpha_coat)));
    };
    facets_ = {width(metal.alpha_x(), coat.facets().alpha_x()),
               width(metal.alpha_y(), coat.facets().alpha_y())};
  }

  bool Exists() const { return wo_.exists && !facets_.IsSmooth(); }

  // Must exist. Returns nullopt if the light does not leave the coat.
  std::optional<Vec3> Sample(Point2 u) const {
    const Vec3 w = Reflect(wo_.below, facets_.SampleReflectingNormal(wo_.below, u));
    const float x = w.x * eta_, y = w.y * eta_;
    const float cos2 = 1 - x * x - y * y;
    if (!(w.z > 0 && cos2 > 0)) return std::nullopt;
    return Vec3{x, y, std::sqrt(cos2)};
  }
  // Must exist. Per solid angle of wi above the coat.
  float Pdf(Vec3 wi) const {
    const Refracted w = RefractBelow(wi, eta_);
    if (!w.exists) return 0;
    const Vec3 h = wo_.below + w.below;
    const float below =
        facets_.ReflectionPdf(wo_.below, facets_.D(h, LengthSquared(h)), facets_.Stretch(wo_.below));
    return below * wi.z / (Sqr(eta_) * w.below.z);
  }

 private:
  float eta_;
  Refracted wo_;
  MicrofacetDistribution facets_;
};

}  // namespace

BxdfFlags LayeredConductorBxdf::flags() const {
  BxdfFlags flags = BxdfFlags::kReflection;
  if (coat_.IsSpecular()) flags = flags | BxdfFlags::kSpecular;
  return IsSpecular() ? flags : flags | BxdfFlags::kGlossy;
}

// Of the light that is reflected without being spread.
SampledSpectrum LayeredConductorBxdf::MirrorReflectance(float cos_o) const {
  const float fresnel = FrDielectric(cos_o, coat_.eta());
  const float sin2_t = (1 - cos_o * cos_o) / Sqr(coat_.eta());
  if (!HasSmoothInterfaces() || !(sin2_t < 1)) return SampledSpectrum(fresnel);
  const float cos_t = std::sqrt(1 - sin2_t);
  const float crossed = Sqr(LayerTransmittance(layer_.thickness, {0, 0, cos_t}));
  const SampledSpectrum round_trip = FrConductor(cos_t, eta_, k_) * crossed;
  SampledSpectrum inner, power(1.0f);
  const int reflections = layer_.depth_max / 2;  // by the metal: every other event of a walk that leaves
  for (int i = 0; i < reflections && MaxElement(power) > 1e-6f; ++i) {
    inner += power;
    power *= round_trip * fresnel;
  }
  return SampledSpectrum(fresnel) + round_trip * inner * Sqr(1 - fresnel);
}

LayeredConductorBxdf::Choice LayeredConductorBxdf::ChoiceAt(Vec3 wo) const {
  if (IsSpecular()) return {1, 0};
  const float mirror = Average(MirrorReflectance(wo.z));
  const float entering = 1 - FrDielectric(wo.z, coat_.eta());
  const Refracted below = RefractBelow(wo, coat_.eta());
  float metal = 0, layer = entering * Average(layer_.albedo);
  if (below.exists) {
    const float crossed = Sqr(LayerTransmittance(layer_.thickness, below.below));
    layer *= 1 - crossed;
    if (MetalLobe(coat_, facets(), wo).Exists()) {
      metal = entering * crossed * Average(FrConductor(below.below.z, eta_, k_));
    }
  }
  const float sum = mirror + metal + layer;
  if (!(sum > 0)) return {};
  const float scale = std::min(1 / sum, (1 - kDiffuseProbabilityMin) / std::max(mirror + metal, 1e-20f));
  return {mirror * scale, metal * scale};
}

BsdfEvaluation LayeredConductorBxdf::EvaluateAbove(Vec3 wo, Vec3 wi, const Choice& choice) const {
  BsdfEvaluation result = coat_.Evaluate(wo, wi, TransportMode::kRadiance, Lobes::kReflection);
  result.pdf *= choice.mirror;
  result.pdf += (1 - choice.mirror - choice.metal) * CosineHemispherePdf(wi.z);
  if (choice.metal > 0) result.pdf += choice.metal * MetalLobe(coat_, facets(), wo).Pdf(wi);

  const ConductorBase base(facets(), eta_, k_);
  const uint64_t seed = Hash(wo, wi);
  SampledSpectrum walks;
  for (int i = 0; i < layer_.sample_count; ++i) {
    walks += LayerWalk(coat_, base, layer_, wi, Hash(seed, i)).Run(wo);
  }
  result.f += walks / static_cast<float>(layer_.sample_count);
  return result;
}

BsdfEvaluation LayeredConductorBxdf::Evaluate(Vec3 wo, Vec3 wi) const {
  if (!SameHemisphere(wo, wi) || IsSpecular()) return {};
  if (wo.z < 0) {
    wo = -wo;
    wi = -wi;
  }
  return EvaluateAbove(wo, wi, ChoiceAt(wo));
}

std::optional<BsdfSample> LayeredConductorBxdf::SampleAbove(Vec3 wo, float uc, Point2 u) const {
  const Choice choice = ChoiceAt(wo);
  BsdfSample sample;
  sample.flags = BxdfFlags::kReflection | BxdfFlags::kGlossy;
  if (uc < choice.mirror) {
    if (coat_.IsSpecular()) {
      return BsdfSample{MirrorReflectance(wo.z) / wo.z, Vec3{-wo.x, -wo.y, wo.z}, choice.mirror,
                        BxdfFlags::kReflection | BxdfFlags::kSpecular, 1};
    }
    const auto coat = coat_.Sample(wo, 0, u, TransportMode::kRadiance, Lobes::kReflection);
    if (!coat) return std::nullopt;
    sample.wi = coat->wi;
  } else if (uc < choice.mirror + choice.metal) {
    const std::optional<Vec3> wi = MetalLobe(coat_, facets(), wo).Sample(u);
    if (!wi) return std::nullopt;
    sample.wi = *wi;
  } else {
    sample.wi = SampleCosineHemisphere(u);
  }
  if (!(sample.wi.z > 0)) return std::nullopt;
  const BsdfEvaluation value = EvaluateAbove(wo, sample.wi, choice);
  sample.f = value.f;
  sample.pdf = value.pdf;
  return sample;
}

std::optional<BsdfSample> LayeredConductorBxdf::Sample(Vec3 wo, float uc, Point2 u) const {
  if (wo.z > 0) return SampleAbove(wo, uc, u);
  std::optional<BsdfSample> sample = SampleAbove(-wo, uc, u);
  if (sample) sample->wi = -sample->wi;
  return sample;
}

}  // namespace tessera
