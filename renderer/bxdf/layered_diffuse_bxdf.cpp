#include "renderer/bxdf/layered_diffuse_bxdf.h"

#include <cmath>
#include <limits>

#include "renderer/bxdf/fresnel.h"
#include "renderer/math/henyey_greenstein.h"
#include "renderer/math/random_stream.h"
#include "renderer/math/sampling.h"

namespace tessera {
namespace {

constexpr int kRouletteDepth = 3;       // no Russian roulette up to this event
constexpr float kRouletteBeta = 0.25f;  // nor while the throughput is at least this
// Of sampling the base: keeps f / pdf bounded where the coat dominates.
constexpr float kCosineProbabilityMin = 0.1f;

float Transmittance(float distance, Vec3 w) {
  if (std::abs(distance) <= std::numeric_limits<float>::min()) return 1;
  return std::exp(-std::abs(distance / w.z));
}

// A walk that starts below the coat. The base is at height 0, the coat at layer.thickness.
class LayerWalk {
 public:
  LayerWalk(const DielectricBxdf& coat, SampledSpectrum reflectance, const CoatLayer& layer, Vec3 wi,
            uint64_t seed)
      : coat_(coat), reflectance_(reflectance), layer_(layer), wi_(wi), random_(seed) {}

  SampledSpectrum Run(Vec3 wo) {
    if (!Enter(wo)) return {};
    for (int depth = 0; depth < layer_.depth_max; ++depth) {
      if (!SurvivesRoulette(depth)) break;
      if (ScattersInLayer()) {
        if (!alive_) break;
        continue;
      }
      if (!(w_.z > 0 ? ReflectAtCoat() : ReflectAtBase())) break;
    }
    return f_;
  }

 private:
  // Refracts wo downwards to start the walk, and wi to find the direction in which its light arrives, which
  // is a virtual light for the walk.
  bool Enter(Vec3 wo) {
    const float uc_o = random_.Next();
    const Point2 u_o = random_.Next2();
    const auto in = coat_.Sample(wo, uc_o, u_o, TransportMode::kRadiance, Lobes::kTransmission);
    const float uc_i = random_.Next();
    const Point2 u_i = random_.Next2();
    const auto out = coat_.Sample(wi_, uc_i, u_i, TransportMode::kImportance, Lobes::kTransmission);
    if (!in || !out) return false;
    beta_ = in->f * (AbsCosTheta(in->wi) / in->pdf);
    w_ = in->wi;
    z_ = layer_.thickness;
    exit_direction_ = out->wi;
    exit_pdf_ = out->pdf;
    exit_value_ = out->f / out->pdf;
    return true;
  }

  bool SurvivesRoulette(int depth) {
    const float beta_max = MaxElement(beta_);
    if (depth <= kRouletteDepth || beta_max >= kRouletteBeta) return beta_max > 0;
    if (random_.Next() >= beta_max) return false;
    beta_ /= beta_max;
    return true;
  }

  // Moves to the next event. True if it is in the layer (then done with); else the walk has reached coat or
  // base.
  bool ScattersInLayer() {
    if (!AnyNonZero(layer_.albedo)) {
      z_ = w_.z > 0 ? layer_.thickness : 0;
      beta_ *= Transmittance(layer_.thickness, w_);
      return false;
    }
    const float distance = -std::log(1 - random_.Next()) * std::abs(w_.z);
    const float z = w_.z > 0 ? z_ + distance : z_ - distance;
    if (z == z_) return true;
    if (!(z > 0 && z < layer_.thickness)) {
      z_ = z > 0 ? layer_.thickness : 0;
      return false;
    }
    z_ = z;
    const float phase_exit = HenyeyGreenstein(-Dot(w_, exit_direction_), layer_.g);
    AddExit(beta_ * layer_.albedo * phase_exit, phase_exit);
    const Point2 u = random_.Next2();
    const Vec3 next = DirectionAround(-w_, SampleHenyeyGreensteinReturn(layer_.g, u.x), u.y);
    const float pdf = HenyeyGreenstein(Dot(w_, next), layer_.g);
    alive_ = pdf > 0 && next.z != 0;
    beta_ *= layer_.albedo;
    w_ = next;
    if (alive_ && w_.z > 0) AddSampled(pdf);
    return true;
  }

  bool ReflectAtCoat() {
    const float uc = random_.Next();
    const Point2 u = random_.Next2();
    const auto sample = coat_.Sample(-w_, uc, u, TransportMode::kRadiance, Lobes::kReflection);
    if (!sample) return false;
    beta_ *= sample->f * (AbsCosTheta(sample->wi) / sample->pdf);
    w_ = sample->wi;
    return true;
  }

  bool ReflectAtBase() {
    const float cos_exit = AbsCosTheta(exit_direction_);
    AddExit(beta_ * reflectance_ * (cos_exit * kInvPi), CosineHemispherePdf(cos_exit));
    w_ = SampleCosineHemisphere(random_.Next2());
    if (w_.z == 0) return false;
    beta_ *= reflectance_;
    AddSampled(CosineHemispherePdf(w_.z));
    return true;
  }

  // Adds light that leaves towards wi along the direction found by Enter. `pdf` is the density with which the
  // event itself would choose that direction.
  void AddExit(SampledSpectrum scattered, float pdf) {
    const float weight = coat_.IsSpecular() ? 1 : PowerHeuristic(exit_pdf_, pdf);
    f_ += scattered * exit_value_ * (weight * Transmittance(layer_.thickness - z_, exit_direction_));
  }
  // The same along w_, which the event chose with density `pdf`. Refraction of importance from wi is the
  // adjoint of that of radiance from w_, so one evaluation gives the value and Enter's density.
  void AddSampled(float pdf) {
    if (coat_.IsSpecular()) return;
    const BsdfEvaluation exit = coat_.Evaluate(wi_, -w_, TransportMode::kImportance, Lobes::kTransmission);
    if (!(exit.pdf > 0)) return;
    f_ += beta_ * exit.f * (PowerHeuristic(pdf, exit.pdf) * Transmittance(layer_.thickness - z_, w_));
  }

  const DielectricBxdf& coat_;
  const SampledSpectrum reflectance_;
  const CoatLayer& layer_;
  const Vec3 wi_;
  RandomStream random_;
  SampledSpectrum f_, beta_, exit_value_;
  Vec3 w_, exit_direction_;
  float z_ = 0, exit_pdf_ = 0;
  bool alive_ = true;
};

}  // namespace

SampledSpectrum LayeredDiffuseBxdf::EstimateWalk(Vec3 wo, Vec3 wi, uint64_t seed) const {
  return LayerWalk(coat_, reflectance_, layer_, wi, seed).Run(wo);
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

std::optional<BsdfSample> LayeredDiffuseBxdf::Sample(Vec3 wo, float uc, Point2 u) const {
  if (wo.z > 0) return SampleAbove(wo, uc, u);
  std::optional<BsdfSample> sample = SampleAbove(-wo, uc, u);
  if (sample) sample->wi = -sample->wi;
  return sample;
}

}  // namespace tessera
