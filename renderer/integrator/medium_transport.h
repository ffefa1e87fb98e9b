// The way of a path and its weights through participating media. Slower than VacuumTransport where there are
// none.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "renderer/integrator/equi_angular_flight.h"
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

  // Sets hit->t to infinity if the ray meets no surface up to where Fly had to look.
  FlightEvent Fly(Ray& ray, Hit* hit, float* t_event, SampledSpectrum* emitted);
  // To be called before Fly where light is to count: where else than after a collision the flight is to find
  // light. Fly then looks for surfaces up to there. Numbers are drawn from the sampler if `is_stratified`.
  // Sets *u_point to two for sampling a point of the light.
  std::optional<EquiAngularFlight::Place> LookForLight(const Ray& ray, bool is_stratified, Point2* u_point);
  // The contribution of a light that was sampled from the place of the last flight, or nullopt if something
  // is in the way of the shadow ray. The medium scatters `phase` of it. pmf: with which light sampling after
  // a collision there takes this light.
  std::optional<SampledSpectrum> PlaceContribution(const EquiAngularFlight::Place& place,
                                                   const SampledLight& sampled, const Ray& shadow,
                                                   float phase, float pmf);
  // At the vertex that the current ray comes from: the density with which LookForLight finds it and `light`,
  // divided by that of a collision there. 0 on surfaces.
  float PlaceDensity(int light) const { return vertex_flight_.RelativeDensity(light, t_vertex_); }
  SampledSpectrum HitContribution(SampledSpectrum emitted, std::optional<float> light_pdf) const {
    const float path_pdf = Average(weights_.r_u);
    const float weight = PowerHeuristic(path_pdf, Average(weights_.r_l) * light_pdf.value_or(0));
    return counted_ * weights_.beta * emitted * (weight / path_pdf);
  }
  std::optional<SampledSpectrum> LightContribution(const SampledLight& sampled, const Ray& shadow,
                                                   const SurfaceInteraction& interaction, SampledSpectrum f,
                                                   float cosine, float pdf) {
    const int medium = MediumTracker::Beyond(interaction, sampled.light.wi, medium_);
    return LightThrough(medium, sampled, shadow, f * cosine, pdf, 0);
  }
  // The same from a point in the current medium, whose phase function has value and density `phase`.
  std::optional<SampledSpectrum> LightContribution(const SampledLight& sampled, const Ray& shadow,
                                                   float phase) {
    const float place_pdf = PlaceDensity(sampled.index) * sampled.light.pdf;
    return LightThrough(medium_, sampled, shadow, SampledSpectrum(phase), phase, place_pdf);
  }

  // As if media on the way were clear, too.
  SampledSpectrum LightUnlessBlocked(const SampledLight& sampled, SampledSpectrum f_cosine) const {
    return counted_ * Throughput() * f_cosine * sampled.light.Radiance(context_.wavelengths) / sampled.pdf;
  }

  void PassInterface(const SurfaceInteraction& interaction, Vec3 d) {
    medium_ = MediumTracker::Beyond(interaction, d, medium_);
  }
  void Scatter(const SurfaceInteraction& interaction, Vec3 wi, SampledSpectrum weight, float pdf) {
    vertex_flight_.Clear();
    weights_.beta *= weight;
    weights_.r_l = weights_.r_u / pdf;
    medium_ = MediumTracker::Beyond(interaction, wi, medium_);
  }
  // The path enters a surface and comes out of it elsewhere, on the same side: in the same medium. `weight`:
  // the throughput of both. `densities`: with which each wavelength would have found the way, relative to the
  // first.
  void ScatterBelow(SampledSpectrum weight, SampledSpectrum densities) {
    vertex_flight_.Clear();
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
  // Light through `medium` to a vertex that scatters f_cosine. pdf: with which its direction is sampled.
  // place_pdf: with which LookForLight finds it, divided by the density of the vertex.
  std::optional<SampledSpectrum> LightThrough(int medium, const SampledLight& sampled, const Ray& shadow,
                                              SampledSpectrum f_cosine, float pdf, float place_pdf) {
    PathWeights passage;
    if (sampled.casts_shadows && !tracker_.Reaches(shadow, medium, sampled.light, &passage))
      return std::nullopt;
    const float arrival = Average(weights_.r_u * passage.r_l);
    const float light_pdf = arrival * sampled.pdf;
    const float path_pdf = sampled.light.is_delta ? 0 : Average(weights_.r_u * passage.r_u) * pdf;
    const float other_pdf = Combined(path_pdf, arrival * place_pdf);
    const float weight = other_pdf == 0 ? 1 : PowerHeuristic(light_pdf, other_pdf);
    return counted_ * weights_.beta * f_cosine * passage.beta * sampled.light.Radiance(context_.wavelengths) *
           (weight / light_pdf);
  }

  const PathContext& context_;
  MediumTracker tracker_;
  EquiAngularFlight flight_;         // of the current ray
  PathWeights start_;                // where it starts
  float t_place_ = 0;                // up to where it looks for light
  EquiAngularFlight vertex_flight_;  // that led to the medium where the current ray starts
  float t_vertex_ = 0;               // at its end
  Float4 wavelength_pdf_;            // at the start of the path
  PathWeights weights_;
  // What each wavelength stands for in the contributions: see FollowFirstWavelength.
  SampledSpectrum counted_{1.0f};
  int medium_;  // of the current ray
};

[[gnu::always_inline]] inline FlightEvent MediumTransport::Fly(Ray& ray, Hit* hit, float* t_event,
                                                               SampledSpectrum* emitted) {
  const World& world = context_.world;
  float u = 0;
  hit->t = std::numeric_limits<float>::infinity();
  if (medium_ >= 0) {
    Dispatch(tracker_.In(medium_), [&](const auto& medium) {
      if (!medium.MayCollide()) return;
      u = context_.sampler.Get1D();
      // What lies beyond the first collision need not be found, unless the medium glows all the way to it.
      if (!world.media[medium_].is_emissive())
        ray.t_max = std::min(std::max(medium.CollisionDistanceMax(u), t_place_), kFlightMax);
    });
  }
  t_place_ = 0;
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
    if (end == FlightEnd::kScattered) {
      vertex_flight_.Follow(flight_);
      t_vertex_ = *t_event;
      return FlightEvent::kInMedium;
    }
  }
  return found ? FlightEvent::kOnSurface : FlightEvent::kEscaped;
}

inline std::optional<EquiAngularFlight::Place> MediumTransport::LookForLight(const Ray& ray,
                                                                             bool is_stratified,
                                                                             Point2* u_point) {
  flight_.Clear();
  t_place_ = 0;
  const LightTable& lights = context_.world.lights;
  if (medium_ < 0 || !lights.has_spheres()) return std::nullopt;
  const HomogeneousCoefficients* const medium =
      Dispatch(tracker_.In(medium_), [](const auto& coefficients) { return coefficients.Homogeneous(); });
  if (medium == nullptr || !AnyNonZero(medium->sigma_s)) return std::nullopt;
  flight_.Start(lights, *medium, ray);
  start_ = weights_;
  // The flights of a long path need no numbers that are well distributed together.
  FlightRandom random(ray);
  const auto next = [&] { return is_stratified ? context_.sampler.Get1D() : random.Next(); };
  const float u_light = next();
  const std::optional<EquiAngularFlight::Place> place = flight_.Sample(u_light, next());
  if (is_stratified) *u_point = context_.sampler.Get2D();
  if (!place) return std::nullopt;
  if (!is_stratified) *u_point = {random.Next(), random.Next()};
  t_place_ = place->t;
  return place;
}

inline std::optional<SampledSpectrum> MediumTransport::PlaceContribution(
    const EquiAngularFlight::Place& place, const SampledLight& sampled, const Ray& shadow, float phase,
    float pmf) {
  PathWeights passage;
  if (sampled.casts_shadows && !tracker_.Reaches(shadow, medium_, sampled.light, &passage))
    return std::nullopt;
  const SampledSpectrum collision = flight_.CollisionDensities(place.t);
  // Densities as LightThrough has them after a collision at the place.
  const SampledSpectrum collided = start_.r_u * collision;
  const float arrival = Average(collided * passage.r_l) * sampled.light.pdf;
  const float path_pdf = sampled.light.is_delta ? 0 : Average(collided * passage.r_u) * phase;
  const float weight = PowerHeuristic(arrival * place.relative_density, Combined(path_pdf, arrival * pmf));
  const float pdf = Average(start_.r_u * passage.r_l) * place.density * sampled.light.pdf;
  const float scale = phase * weight / pdf;
  if (!std::isfinite(scale)) return std::nullopt;  // so far away that nothing arrives
  return counted_ * start_.beta * collision * flight_.Unabsorbed(place.t) * passage.beta *
         sampled.light.Radiance(context_.wavelengths) * scale;
}

}  // namespace tessera
