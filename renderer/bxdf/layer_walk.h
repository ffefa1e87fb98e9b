// The random walk between a coat and its base that estimates the BSDF of both together (Guo, Hasan, Zhao
// 2018; pbrt-v4's LayeredBxDF). For the sources of the layered BxDFs; each brings its own base.
#pragma once

#include <cmath>

#include "renderer/bxdf/coat_layer.h"
#include "renderer/bxdf/dielectric_bxdf.h"
#include "renderer/bxdf/fresnel.h"
#include "renderer/math/henyey_greenstein.h"
#include "renderer/math/random_stream.h"
#include "renderer/math/sampling.h"

namespace tessera {

// Light that a base reflects into a direction that was given, and the density with which the base itself
// would have chosen it.
struct BaseReflection {
  SampledSpectrum scattered;  // throughput times f times cosine
  float pdf = 0;
};

// How a walk leaves the base in a direction that the base chose.
struct BaseBounce {
  SampledSpectrum beta;  // throughput afterwards
  Vec3 w;
  float pdf = 0;  // infinite if the base is a mirror
};

// A walk that starts below the coat. The base is at height 0, the coat at layer.thickness. Directions at the
// base point away from it. A Base has
//   static constexpr bool kMayBeMirror;
//   SampledSpectrum MirrorReflectance(float cos_theta) const;  if kMayBeMirror; 0 if it is rough
//   BaseReflection ReflectTowards(SampledSpectrum beta, Vec3 wo, Vec3 wi) const;
//   std::optional<BaseBounce> Bounce(SampledSpectrum beta, Vec3 wo, RandomStream& random) const;
template <typename Base>
class LayerWalk {
 public:
  LayerWalk(const DielectricBxdf& coat, const Base& base, const CoatLayer& layer, Vec3 wi, uint64_t seed)
      : coat_(coat), base_(base), layer_(layer), wi_(wi), random_(seed) {}

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
  static constexpr int kRouletteDepth = 3;       // no Russian roulette up to this event
  static constexpr float kRouletteBeta = 0.25f;  // nor while the throughput is at least this

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
      beta_ *= LayerTransmittance(layer_.thickness, w_);
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
    if constexpr (Base::kMayBeMirror) AddMirroredExit(phase_exit);
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
    const BaseReflection exit = base_.ReflectTowards(beta_, -w_, -exit_direction_);
    AddExit(exit.scattered, exit.pdf);
    const std::optional<BaseBounce> bounce = base_.Bounce(beta_, -w_, random_);
    if (!bounce) return false;
    w_ = bounce->w;
    beta_ = bounce->beta;
    AddSampled(bounce->pdf);
    return true;
  }

  // Adds light that leaves towards wi along the direction found by Enter. `pdf` is the density with which the
  // event itself would choose that direction.
  void AddExit(SampledSpectrum scattered, float pdf) {
    const float weight = coat_.IsSpecular() ? 1 : PowerHeuristic(exit_pdf_, pdf);
    f_ += scattered * exit_value_ * (weight * LayerTransmittance(layer_.thickness - z_, exit_direction_));
  }
  // Adds light that leaves a smooth coat from an event in the layer after reflections by a base that is a
  // mirror: no later event could find it. All such paths together, of whatever number of reflections.
  void AddMirroredExit(float phase_exit) {
    if (!coat_.IsSpecular()) return;
    const Vec3 exit = exit_direction_;
    const SampledSpectrum mirror = base_.MirrorReflectance(AbsCosTheta(exit));
    const float coat = FrDielectric(exit.z, coat_.eta());
    const SampledSpectrum around = mirror * (coat * LayerTransmittance(2 * layer_.thickness, exit));
    const SampledSpectrum repeated = SafeDiv(around, 1.0f - around);
    const float phase_mirrored = HenyeyGreenstein(-Dot(w_, Vec3{exit.x, exit.y, -exit.z}), layer_.g);
    const float direct = phase_exit * LayerTransmittance(layer_.thickness - z_, exit);
    const float mirrored = phase_mirrored * LayerTransmittance(layer_.thickness + z_, exit);
    f_ += beta_ * layer_.albedo * exit_value_ *
          (repeated * direct + mirror * (SampledSpectrum(1.0f) + repeated) * mirrored);
  }
  // The same along w_, which the event chose with density `pdf`. Refraction of importance from wi is the
  // adjoint of that of radiance from w_, so one evaluation gives the value and Enter's density.
  void AddSampled(float pdf) {
    if (coat_.IsSpecular()) return;
    const BsdfEvaluation exit = coat_.Evaluate(wi_, -w_, TransportMode::kImportance, Lobes::kTransmission);
    if (!(exit.pdf > 0)) return;
    f_ += beta_ * exit.f * (PowerHeuristic(pdf, exit.pdf) * LayerTransmittance(layer_.thickness - z_, w_));
  }

  const DielectricBxdf& coat_;
  const Base& base_;
  const CoatLayer& layer_;
  const Vec3 wi_;
  RandomStream random_;
  SampledSpectrum f_, beta_, exit_value_;
  Vec3 w_, exit_direction_;
  float z_ = 0, exit_pdf_ = 0;
  bool alive_ = true;
};

}  // namespace tessera
