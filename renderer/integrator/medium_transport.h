// The way of a path and its weights through participating media. Slower than VacuumTransport where there are
// none.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include "renderer/integrator/medium_tracker.h"
#include "renderer/integrator/vacuum_transport.h"

namespace tessera {

// A Transport of PathTracer, as VacuumTransport. Techniques are weighted on two levels: the balance heuristic
// between the wavelengths that may decide (medium/flight.h), the power heuristic between the densities that
// this gives light sampling and the sampling of directions.
class MediumTransport {
 public:
  static constexpr bool kHasMedia = true;

  explicit MediumTransport(const PathContext& context)
      : context_(context),
        tracker_(context),
        wavelength_pdf_(context.wavelengths.pdf),
        medium_(context.world.camera_medium) {}

  FlightEvent Fly(Ray& ray, Hit* hit, float* t_event, SampledSpectrum* emitted);
  SampledSpectrum HitContribution(SampledSpectrum emitted, std::optional<float> light_pdf) const {
    const float path_pdf = Average(weights_.r_u);
    const float weight = PowerHeuristic(path_pdf, Average(weights_.r_l) * light_pdf.value_or(0));
    return counted_ * weights_.beta * emitted * (weight / path_pdf);
  }
  std::optional<SampledSpectrum> LightContribution(const SampledLight& sampled, const Ray& shadow,
                                                   const SurfaceInteraction& interaction, SampledSpectrum f,
                                                   float cosine, float pdf) {
    const int medium = MediumTracker::Beyond(interaction, sampled.light.wi, medium_);
    return LightThrough(medium, sampled, shadow, f * cosine, pdf);
  }
  // The same from a point in the current medium, whose phase function has value and density `phase`.
  std::optional<SampledSpectrum> LightContribution(const SampledLight& sampled, const Ray& shadow,
                                                   float phase) {
    return LightThrough(medium_, sampled, shadow, SampledSpectrum(phase), phase);
  }

  // As if media on the way were clear, too.
  SampledSpectrum LightUnlessBlocked(const SampledLight& sampled, SampledSpectrum f_cosine) const {
    return counted_ * Throughput() * f_cosine * sampled.light.Radiance(context_.wavelengths) / sampled.pdf;
  }

  void PassInterface(const SurfaceInteraction& interaction, Vec3 d) {
    medium_ = MediumTracker::Beyond(interaction, d, medium_);
  }
  void Scatter(const SurfaceInteraction& interaction, Vec3 wi, SampledSpectrum weight, float pdf) {
    weights_.beta *= weight;
    weights_.r_l = weights_.r_u / pdf;
    medium_ = MediumTracker::Beyond(interaction, wi, medium_);
  }
  // The path enters a surface and comes out of it elsewhere, on the same side: in the same medium. `weight`:
  // the throughput of both. `densities`: with which each wavelength would have found the way, relative to the
  // first.
  void ScatterBelow(SampledSpectrum weight, SampledSpectrum densities) {
    weights_.beta *= weight;
    weights_.r_u *= densities;
  }
  // The path leaves a point in the medium. beta does not change: the value of the phase function is its
  // density.
  void ScatterInMedium(float pdf) { weights_.r_l = weights_.r_u / pdf; }
  // After dispersion the first wavelength alone decides and alone carries light, for all four. What was found
  // before still counts at all of them: their densities relative to each other belong to paths that had not
  // dispersed.
  void FollowFirstWavelength() {
    counted_ = SampledSpectrum(4, 0, 0, 0);
    weights_.beta = SampledSpectrum(weights_.beta[0], 0, 0, 0);
    weights_.r_u = SampledSpectrum(weights_.r_u[0]);
    weights_.r_l = SampledSpectrum(weights_.r_l[0]);
    tracker_.Forget();
  }
  SampledSpectrum Throughput() const { return weights_.Throughput(); }
  void Survive(float probability) { weights_.beta /= probability; }
  void Finish() { context_.wavelengths.pdf = wavelength_pdf_; }  // counted_ has seen to dispersion

  const PhaseFunction& phase() const { return context_.world.media[medium_].phase(); }

 private:
  // Light through `medium` to a vertex that scatters f_cosine.
  std::optional<SampledSpectrum> LightThrough(int medium, const SampledLight& sampled, const Ray& shadow,
                                              SampledSpectrum f_cosine, float pdf) {
    PathWeights passage;
    if (sampled.casts_shadows && !tracker_.Reaches(shadow, medium, sampled.light, &passage))
      return std::nullopt;
    const float light_pdf = Average(weights_.r_u * passage.r_l) * sampled.pdf;
    const float path_pdf = Average(weights_.r_u * passage.r_u) * pdf;
    const float weight = sampled.light.is_delta ? 1 : PowerHeuristic(light_pdf, path_pdf);
    return counted_ * weights_.beta * f_cosine * passage.beta * sampled.light.Radiance(context_.wavelengths) *
           (weight / light_pdf);
  }

  const PathContext& context_;
  MediumTracker tracker_;
  Float4 wavelength_pdf_;  // at the start of the path
  PathWeights weights_;
  // What each wavelength stands for in the contributions: see FollowFirstWavelength.
  SampledSpectrum counted_{1.0f};
  int medium_;  // of the current ray
};

[[gnu::always_inline]] inline FlightEvent MediumTransport::Fly(Ray& ray, Hit* hit, float* t_event,
                                                               SampledSpectrum* emitted) {
  const World& world = context_.world;
  float u = 0;
  if (medium_ >= 0) {
    Dispatch(tracker_.In(medium_), [&](const auto& medium) {
      if (!medium.MayCollide()) return;
      u = context_.sampler.Get1D();
      // What lies beyond the first collision need not be found, unless the medium glows all the way to it.
      if (!world.media[medium_].is_emissive())
        ray.t_max = std::min(medium.CollisionDistanceMax(u), kFlightMax);
    });
  }
  const bool found = world.accelerator->Intersect(ray, hit);
  if (medium_ >= 0) {
    FlightRandom random(ray, u);
    const bool emits = emitted != nullptr && world.media[medium_].is_emissive();
    const float t_max = found ? hit->t : std::numeric_limits<float>::infinity();
    const FlightEnd end = Dispatch(tracker_.In(medium_), [&](const auto& medium) {
      return tessera::Fly(medium.RayAlong(ray), t_max, random, &weights_, emits ? emitted : nullptr, t_event);
    });
    if (emits) *emitted = counted_ * *emitted;
    if (end == FlightEnd::kAbsorbed) return FlightEvent::kAbsorbed;
    if (end == FlightEnd::kScattered) return FlightEvent::kInMedium;
  }
  return found ? FlightEvent::kOnSurface : FlightEvent::kEscaped;
}

}  // namespace tessera
