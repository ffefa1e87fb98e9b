// One path from the camera as it is extended ray by ray. The contract of the whole is in path_integrator.h.
#pragma once

#include <limits>
#include <optional>

#include "renderer/integrator/light_visibility.h"
#include "renderer/integrator/medium_transport.h"
#include "renderer/integrator/path_vertex.h"
#include "renderer/integrator/sample_record.h"
#include "renderer/integrator/subsurface_probe.h"
#include "renderer/integrator/vacuum_transport.h"
#include "renderer/shape/shape_interaction.h"

namespace tessera {

// One path from the camera, extended ray by ray. The Transport knows how rays get from vertex to vertex and
// what the path's contributions weigh; the Sink receives them.
template <typename Transport, typename Sink>
class PathTracer {
 public:
  PathTracer(const PathContext& context, const LightVisibility* visibility, const Ray& camera_ray, Sink& sink)
      : context_(context), visibility_(visibility), sink_(sink), transport_(context_), ray_(camera_ray) {
    previous_.p = camera_ray.o;
  }

  void Trace() {
    while (Extend()) {
    }
    transport_.Finish();
  }

  // The parts of Extend where no ray is in a medium, for callers that find the hit themselves.
  const Ray& BeginFlight() {
    (depth_ == 0 ? context_.counts.camera : context_.counts.bounce) += 1;
    return ray_;
  }
  // Each returns false if the path ends.
  bool MeetSurface(const Hit& hit, SurfaceInteraction& interaction);
  bool Escape();

 private:
  friend class PlainVertices;  // computes the vertices of several paths together

  // The same.
  bool Extend();
  bool CrossInterface(const SurfaceInteraction& interaction);
  bool PassHidden(const SurfaceInteraction& interaction);
  bool ScatterInMedium(float t);
  bool ScatterOnSurface(SurfaceInteraction& interaction);
  bool FollowDirection(const SurfaceInteraction& interaction, const Bsdf& bsdf, const BsdfSample& sample);
  void Leave(const SurfaceInteraction& interaction, const BsdfSample& sample);
  bool ComeOut(const SurfaceInteraction& entry, const BsdfSample& entered);
  bool SurvivesRoulette() {
    const float end_probability = EndProbability(MaxElement(transport_.Throughput()) * eta_scale_, depth_);
    return !(end_probability > 0) || SurvivesRoulette(end_probability);
  }
  bool SurvivesRoulette(float end_probability);
  bool PassesDelayedRoulette() { return !is_sharp_ || SurvivesRoulette(); }

  FlightEvent Fly(Hit* hit, float* t_event);
  bool UsesLinks() const { return context_.world.links.any() || is_shadowed_; }
  // Whether light of a light that the ray hits counts.
  bool CountsHit(int light) const {
    return HitCounts(context_.world.links, light, {depth_, !weigh_, is_shadowed_, previous_.light_links});
  }
  // With which probability a light is sampled at a vertex: always at the first, since its light and shadows
  // are visible in the picture.
  void SetLightShare() { light_share_ = LightShare(previous_.p, depth_); }
  float LightShare(Point3 p, int depth) const {
    return visibility_ == nullptr || depth == 1 ? 1 : visibility_->SamplingProbability(p);
  }
  void AddInfiniteLights();
  void AddEmission(const SurfaceInteraction& interaction);
  // A light sampled at a surface, and what the surface scatters of it.
  struct SurfaceLight {
    std::optional<SampledLight> sampled;  // if its light is scattered at all
    BsdfEvaluation scattered;
  };
  SurfaceLight SampleSurfaceLight(const SurfaceInteraction& interaction, const Bsdf& bsdf);
  void AddSurfaceLight(const SurfaceInteraction& interaction, const Bsdf& bsdf, const SurfaceLight& light);
  std::optional<BsdfSample> DrawDirection(Vec3 wo, const Bsdf& bsdf) {
    const float u_component = context_.sampler.Get1D();
    const Point2 u_direction = context_.sampler.Get2D();
    return bsdf.Sample(wo, u_component, u_direction);
  }
  void AddMediumLight(Vec3 wo, const PhaseFunction& phase);
  void AddPlaceLight(const EquiAngularFlight::Place& place, Point2 u);

  void Add(SampledSpectrum contribution, int light) { sink_.Add(contribution, {light, depth_, first_}); }
  // Both to be called once depth_ counts the vertex, before what it scatters is added.
  void NoteScatter(const Bsdf& bsdf, Vec3 wo, Vec3 wi, bool is_specular) {
    if constexpr (Sink::kRecords) {
      if (depth_ == 1 && sink_.needs().lobes) first_ = FirstVertexAt(bsdf, wo, wi, is_specular);
    }
  }
  void NoteMedium() {
    if constexpr (Sink::kRecords) {
      if (depth_ == 1) first_ = {FirstScatter::kMedium};
    }
  }
  // Light of this vertex does not arrive.
  void NoteShadow(const SampledLight& sampled, SampledSpectrum f_cosine) {
    if constexpr (Sink::kRecords) {
      if (depth_ == 1 && sink_.needs().shadow)
        sink_.AddShadow(transport_.LightUnlessBlocked(sampled, f_cosine));
    }
  }

  const PathContext context_;
  const LightVisibility* const visibility_;
  Sink& sink_;
  Transport transport_;
  Ray ray_;
  int depth_ = 0;       // scattering events
  int interfaces_ = 0;  // crossed since the last of them
  FirstVertex first_;
  bool was_spread_ = false;  // whether any event was not specular
  // Whether the ray has passed hidden surfaces that cast shadows since the path last scattered.
  bool is_shadowed_ = false;
  bool weigh_ = false;     // whether light sampling could have found what the current ray hits
  bool is_sharp_ = false;  // whether it hardly could have: roulette is delayed
  // Radiance is compressed inside denser media; roulette looks at what will leave them.
  float eta_scale_ = 1;
  float light_share_ = 1;    // the probability with which a light was sampled at previous_
  ReferencePoint previous_;  // where the path last scattered: at the camera or a vertex
};

template <typename Transport, typename Sink>
bool PathTracer<Transport, Sink>::Extend() {
  Hit hit;
  float t_event = 0;
  switch (Fly(&hit, &t_event)) {
    case FlightEvent::kOnSurface: break;
    case FlightEvent::kInMedium: return PassesDelayedRoulette() && ScatterInMedium(t_event);
    case FlightEvent::kEscaped: return Escape();
    case FlightEvent::kAbsorbed: return false;
  }
  SurfaceInteraction interaction = MakeInteraction(context_.world.geometry, hit, ray_);
  return MeetSurface(hit, interaction);
}

template <typename Transport, typename Sink>
bool PathTracer<Transport, Sink>::Escape() {
  if constexpr (Sink::kRecords) {
    if (depth_ == 0) sink_.Escape(transport_.Throughput());
  }
  AddInfiniteLights();
  return false;
}

template <typename Transport, typename Sink>
bool PathTracer<Transport, Sink>::MeetSurface(const Hit& hit, SurfaceInteraction& interaction) {
  if (IsHidden(interaction, depth_)) return PassHidden(interaction);
  if (interaction.area_light >= 0) AddEmission(interaction);
  if (context_.world.materials.IsInterface(interaction.material)) return CrossInterface(interaction);
  if constexpr (Sink::kRecords) {
    if (depth_ == 0) {
      sink_.ReachFirstSurface(context_, hit, interaction);
    } else if (!was_spread_) {
      sink_.ReachNextSurface(context_, interaction, transport_.Throughput());
    }
  }
  return PassesDelayedRoulette() && ScatterOnSurface(interaction);
}

template <typename Transport, typename Sink>
FlightEvent PathTracer<Transport, Sink>::Fly(Hit* hit, float* t_event) {
  BeginFlight();
  if constexpr (Transport::kHasMedia) {
    SampledSpectrum emitted(0.0f);
    const bool counts_light = depth_ < context_.settings.max_depth;
    std::optional<EquiAngularFlight::Place> place;
    Point2 u_point;
    if (counts_light) place = transport_.LookForLight(ray_, depth_ == 0, &u_point);
    const FlightEvent event = transport_.Fly(ray_, hit, t_event, counts_light ? &emitted : nullptr);
    if (AnyNonZero(emitted)) Add(emitted, LightPath::kMediumEmission);
    if (place && place->t < hit->t) AddPlaceLight(*place, u_point);
    return event;
  } else {
    return transport_.Fly(ray_, hit, nullptr, nullptr);
  }
}

template <typename Transport, typename Sink>
bool PathTracer<Transport, Sink>::CrossInterface(const SurfaceInteraction& interaction) {
  transport_.PassInterface(interaction, ray_.d);
  ray_ = interaction.SpawnRay(ray_.d);
  return ++interfaces_ <= kInterfacesMax;
}

// The surface is not there for this ray, nor is the medium inside it.
template <typename Transport, typename Sink>
bool PathTracer<Transport, Sink>::PassHidden(const SurfaceInteraction& interaction) {
  is_shadowed_ |= depth_ > 0 && (interaction.hidden_from & kHiddenFromShadowRays) == 0;
  ray_ = interaction.SpawnRay(ray_.d);
  return ++interfaces_ <= kInterfacesMax;
}

template <typename Transport, typename Sink>
bool PathTracer<Transport, Sink>::ScatterInMedium(float t) {
  if constexpr (Transport::kHasMedia) {
    if (depth_++ == context_.settings.max_depth) return false;
    NoteMedium();
    interfaces_ = 0;
    is_shadowed_ = false;
    const PhaseFunction& phase = transport_.phase();
    const Vec3 wo = -ray_.d;
    previous_ = {ray_.At(t), {}, {}, {}, ray_.time, context_.world.links.media()};
    AddMediumLight(wo, phase);
    const PhaseSample sample = phase.Sample(wo, context_.sampler.Get2D());
    transport_.ScatterInMedium(sample.pdf);
    weigh_ = was_spread_ = true;
    ray_ = {previous_.p, sample.wi, std::numeric_limits<float>::infinity(), ray_.time};
    is_sharp_ = IsSharp(sample.pdf);
    return is_sharp_ || SurvivesRoulette();
  }
  return false;
}

template <typename Transport, typename Sink>
bool PathTracer<Transport, Sink>::ScatterOnSurface(SurfaceInteraction& interaction) {
  if (depth_++ == context_.settings.max_depth) return false;
  interfaces_ = 0;
  is_shadowed_ = false;
  const bool had_all_wavelengths = !context_.wavelengths.SecondaryTerminated();
  const Bsdf bsdf = BsdfAt(context_, interaction, context_.settings.regularize && was_spread_);
  if (had_all_wavelengths && context_.wavelengths.SecondaryTerminated()) transport_.FollowFirstWavelength();
  SetReference(interaction, bsdf, &previous_);
  // Both samples come before the shadow ray: a processor overlaps their long chains of dependent operations,
  // but not with a traversal in between.
  const SurfaceLight light = bsdf.HasNonSpecular() ? SampleSurfaceLight(interaction, bsdf) : SurfaceLight();
  const std::optional<BsdfSample> sample = DrawDirection(interaction.wo, bsdf);
  AddSurfaceLight(interaction, bsdf, light);
  return sample && FollowDirection(interaction, bsdf, *sample) && (is_sharp_ || SurvivesRoulette());
}

template <typename Transport, typename Sink>
bool PathTracer<Transport, Sink>::FollowDirection(const SurfaceInteraction& interaction, const Bsdf& bsdf,
                                                  const BsdfSample& sample) {
  NoteScatter(bsdf, interaction.wo, sample.wi, sample.IsSpecular());
  if constexpr (Transport::kHasMedia) {
    if (sample.IsTransmission() && context_.world.materials.ScattersBelow(interaction.material))
      return ComeOut(interaction, sample);
  }
  Leave(interaction, sample);
  return true;
}

template <typename Transport, typename Sink>
void PathTracer<Transport, Sink>::Leave(const SurfaceInteraction& interaction, const BsdfSample& sample) {
  const float cosine = AbsDot(sample.wi, interaction.shading.n);
  transport_.Scatter(interaction, sample.wi, sample.f * (cosine / sample.pdf), sample.pdf);
  weigh_ = !sample.IsSpecular();
  is_sharp_ = sample.IsSpecular() || IsSharp(sample.pdf);
  was_spread_ |= weigh_;
  if (sample.IsTransmission()) eta_scale_ *= Sqr(sample.eta);
  interaction.SpawnRay(sample.wi, &ray_);
}

// The path entered the surface at `entry`; below it is scattered until it comes out. Both count as one event.
template <typename Transport, typename Sink>
bool PathTracer<Transport, Sink>::ComeOut(const SurfaceInteraction& entry, const BsdfSample& entered) {
  if constexpr (Transport::kHasMedia) {
    bool is_subsurface = false;
    const std::optional<SubsurfaceExit> exit = SampleSubsurface(context_, entry, &is_subsurface);
    if (!is_subsurface) Leave(entry, entered);
    if (!exit) return !is_subsurface;
    // Radiance is compressed by eta^2 inside; where it comes out it is no more.
    const float factor = AbsDot(entered.wi, entry.shading.n) * Sqr(entered.eta) / entered.pdf;
    transport_.ScatterBelow(entered.f * exit->weight * factor, exit->densities);
    SetReference(exit->interaction, exit->bsdf, &previous_);
    AddSurfaceLight(exit->interaction, exit->bsdf, SampleSurfaceLight(exit->interaction, exit->bsdf));
    const std::optional<BsdfSample> sample = DrawDirection(exit->interaction.wo, exit->bsdf);
    if (!sample) return false;
    NoteScatter(exit->bsdf, exit->interaction.wo, sample->wi, sample->IsSpecular());
    Leave(exit->interaction, *sample);
    return true;
  }
  return false;
}

// Ends paths of little throughput with a probability that keeps the mean.
template <typename Transport, typename Sink>
bool PathTracer<Transport, Sink>::SurvivesRoulette(float end_probability) {
  if (context_.sampler.Get1D() < end_probability) return false;
  transport_.Survive(1 - end_probability);
  return true;
}

template <typename Transport, typename Sink>
void PathTracer<Transport, Sink>::AddInfiniteLights() {
  const World& world = context_.world;
  for (const int light : world.lights.infinite_lights()) {
    if (UsesLinks() && !CountsHit(light)) continue;
    const SampledSpectrum emitted =
        world.lights.InfiniteRadiance(light, previous_.p, ray_.d, ray_.time, context_.wavelengths);
    std::optional<float> light_pdf;
    if (weigh_) light_pdf = light_share_ * InfiniteLightPdf(world, previous_, ray_.d, light);
    Add(transport_.HitContribution(emitted, light_pdf), light);
  }
}

template <typename Transport, typename Sink>
void PathTracer<Transport, Sink>::AddEmission(const SurfaceInteraction& interaction) {
  const World& world = context_.world;
  if (UsesLinks() && !CountsHit(interaction.area_light)) return;
  const SampledSpectrum emitted =
      world.lights.EmittedRadiance(interaction.area_light, interaction, -ray_.d, context_.wavelengths);
  if (!AnyNonZero(emitted)) return;
  std::optional<float> light_pdf;
  if (weigh_) {
    float place_density = 0;
    if constexpr (Transport::kHasMedia) place_density = transport_.PlaceDensity(interaction.area_light);
    light_pdf = EmitterPdf(world, previous_, ray_.d, interaction, light_share_, place_density);
  }
  Add(transport_.HitContribution(emitted, light_pdf), interaction.area_light);
}

template <typename Transport, typename Sink>
auto PathTracer<Transport, Sink>::SampleSurfaceLight(const SurfaceInteraction& interaction, const Bsdf& bsdf)
    -> SurfaceLight {
  SetLightShare();
  SurfaceLight light{SampleOneLight(context_, previous_, interaction, light_share_), {}};
  if (light.sampled) {
    light.scattered = bsdf.Evaluate(interaction.wo, light.sampled->light.wi);
    if (!AnyNonZero(light.scattered.f)) light.sampled.reset();
  }
  return light;
}

// Adds the light if nothing is in its way.
template <typename Transport, typename Sink>
void PathTracer<Transport, Sink>::AddSurfaceLight(const SurfaceInteraction& interaction, const Bsdf& bsdf,
                                                  const SurfaceLight& light) {
  if (!light.sampled) return;
  const SampledLight& sampled = *light.sampled;
  const BsdfEvaluation& scattered = light.scattered;
  NoteScatter(bsdf, interaction.wo, sampled.light.wi, false);
  const float cosine = AbsDot(sampled.light.wi, interaction.shading.n);
  const std::optional<SampledSpectrum> contribution = transport_.LightContribution(
      sampled, ShadowRay(interaction, sampled.light), interaction, scattered.f, cosine, scattered.pdf);
  if (!contribution) return NoteShadow(sampled, scattered.f * cosine);
  Add(*contribution, sampled.index);
}

template <typename Transport, typename Sink>
void PathTracer<Transport, Sink>::AddMediumLight(Vec3 wo, const PhaseFunction& phase) {
  SetLightShare();
  const std::optional<SampledLight> sampled = SampleOneLight(context_, previous_, light_share_);
  if (!sampled) return;
  const LightSample& light = sampled->light;
  const Ray shadow = SpawnRayTo(previous_.p, {}, {}, light.p, light.p_error, light.n, ray_.time);
  const float scattered = phase.Evaluate(wo, light.wi);
  const std::optional<SampledSpectrum> contribution =
      transport_.LightContribution(*sampled, shadow, scattered);
  if (!contribution) return NoteShadow(*sampled, SampledSpectrum(scattered));
  Add(*contribution, sampled->index);
}

// Adds light that the medium scatters at a place on the ray which no surface hides.
template <typename Transport, typename Sink>
void PathTracer<Transport, Sink>::AddPlaceLight(const EquiAngularFlight::Place& place, Point2 u) {
  if constexpr (Transport::kHasMedia) {
    const World& world = context_.world;
    const ReferencePoint reference{ray_.At(place.t), {}, {}, {}, ray_.time, world.links.media()};
    std::optional<SampledLight> sampled = SampleLight(context_, {place.light, 1}, reference, u);
    if (!sampled || (world.links.any() && !FollowLink(context_, reference, *sampled))) return;
    const LightSample& light = sampled->light;
    const Ray shadow = SpawnRayTo(reference.p, {}, {}, light.p, light.p_error, light.n, ray_.time);
    const float phase = transport_.phase().Evaluate(-ray_.d, light.wi);
    const float pmf = LightShare(reference.p, depth_ + 1) * world.lights.ChoosePmf(reference, place.light);
    const std::optional<SampledSpectrum> contribution =
        transport_.PlaceContribution(place, *sampled, shadow, phase, pmf);
    if (!contribution) return;
    const FirstVertex first = depth_ == 0 ? FirstVertex{FirstScatter::kMedium} : first_;
    sink_.Add(*contribution, {place.light, depth_ + 1, first});
  }
}

}  // namespace tessera
