#include "renderer/integrator/light_walk.h"

#include <algorithm>

#include "renderer/integrator/path_vertex.h"
#include "renderer/shape/shape_interaction.h"

namespace tessera {

template <typename Sink>
LightWalk<Sink>::LightWalk(const PathContext& context, const Ray& camera_ray, Sink& sink)
    : ray(camera_ray),
      context_(context),
      sink_(sink),
      tracker_(context),
      origin_(camera_ray.o),
      medium_(context.world.camera_medium) {}

template <typename Sink>
typename LightWalk<Sink>::Event LightWalk<Sink>::Advance() {
  const World& world = context_.world;
  for (int interfaces = 0; interfaces < kInterfacesMax; ++interfaces) {
    ++(depth_ == 0 ? context_.counts.camera : context_.counts.bounce);
    Hit hit;
    const bool found = world.accelerator->Intersect(ray, &hit);
    const float t_max = found ? hit.t : kFlightMax;
    const auto collides = [&](const auto& medium) { return Collides(medium, t_max); };
    if (medium_ >= 0 && Dispatch(tracker_.In(medium_), collides)) {
      in_medium_ = true;
      return Event::kInMedium;
    }
    if (!found) {
      if constexpr (Sink::kRecords) {
        if (depth_ == 0) sink_.Escape(throughput_);
      }
      return Event::kEscaped;
    }
    interaction = MakeInteraction(world.geometry, hit, ray);
    if (IsHidden(interaction, depth_)) {
      is_shadowed_ |= depth_ > 0 && (interaction.hidden_from & kHiddenFromShadowRays) == 0;
      ray = interaction.SpawnRay(ray.d);
      continue;
    }
    if (!world.materials.IsInterface(interaction.material)) {
      in_medium_ = false;
      if constexpr (Sink::kRecords) {
        if (depth_ == 0) {
          sink_.ReachFirstSurface(context_, hit, interaction);
        } else if (!was_spread_) {
          sink_.ReachNextSurface(context_, interaction, throughput_);
        }
      }
      return Event::kOnSurface;
    }
    medium_ = MediumTracker::Beyond(interaction, ray.d, medium_);
    ray = interaction.SpawnRay(ray.d);
  }
  throughput_ = SampledSpectrum(0.0f);  // caught in rounding errors
  return Event::kEscaped;
}

template <typename Sink>
bool LightWalk<Sink>::Collides(const HomogeneousCoefficients& medium, float t_max) {
  const float u = context_.sampler.Get1D() * 4;
  const int deciding = std::min(static_cast<int>(u), 3);
  const SampledSpectrum sigma_t = medium.sigma_a + medium.sigma_s;
  if (AnyNonZero(medium.emission)) {
    sink_.Add(throughput_ * medium.emission * IntegralOfExp(sigma_t, t_max),
              {LightPath::kMediumEmission, depth_, first_});
  }
  const float t = SampleExponential(u - static_cast<float>(deciding), medium.sigma_s[deciding]);
  if (t < t_max) {
    const float pdf = Average(medium.sigma_s * Exp(medium.sigma_s * -t));
    throughput_ *= medium.sigma_s * Exp(sigma_t * -t) * (1 / pdf);
    ray.o = ray.At(t);
    return true;
  }
  const float probability = Average(Exp(medium.sigma_s * -t_max));
  throughput_ =
      probability > 0 ? throughput_ * Exp(sigma_t * -t_max) * (1 / probability) : SampledSpectrum(0.0f);
  return false;
}

template <typename Sink>
template <typename Coefficients>
bool LightWalk<Sink>::Collides(const Coefficients& medium, float t_max) {
  FlightRandom random(ray, context_.sampler.Get1D());
  flight::CollisionDepth depth(random);
  auto medium_ray = medium.RayAlong(ray);
  float t = 0;
  MajorantSegment segment;
  while (t < t_max && medium_ray.Next(&segment)) {
    const float end = std::min(segment.t_end, t_max);
    const float majorant = MaxElement(segment.sigma_maj);
    for (float rest = end - t;;) {
      rest -= depth.Advance(majorant, rest);
      if (!depth.Collided()) break;
      t = end - rest;
      const MediumPoint point = medium_ray.At(t);
      throughput_ /= majorant;
      if (AnyNonZero(point.emission)) Add(point.emission, LightPath::kMediumEmission);
      const SampledSpectrum scattered = throughput_ * point.sigma_s;
      const SampledSpectrum passed =
          throughput_ * Max(SampledSpectrum(majorant) - point.sigma_a - point.sigma_s, SampledSpectrum(0.0f));
      const float scatters = Average(scattered) / (Average(scattered) + Average(passed));
      const bool is_collision = random.Next() < scatters;
      throughput_ = is_collision ? scattered / scatters : passed / (1 - scatters);
      if (!AllFinite(throughput_)) throughput_ = SampledSpectrum(0.0f);  // all is absorbed
      if (is_collision || !AnyNonZero(throughput_)) {
        ray.o = ray.At(t);
        return true;
      }
    }
    t = end;
  }
  return false;
}

template <typename Sink>
void LightWalk<Sink>::Leave(const Ray& next, SampledSpectrum weight, const FirstVertex& vertex,
                            bool is_specular) {
  throughput_ *= weight;
  was_specular_ = is_specular;
  was_spread_ |= !is_specular;
  is_shadowed_ = false;
  light_links_ = in_medium_ ? context_.world.links.media() : interaction.light_links;
  if (depth_ == 0) first_ = vertex;
  ++depth_;
  ray = next;
  origin_ = next.o;
  if (!in_medium_) medium_ = MediumTracker::Beyond(interaction, ray.d, medium_);
}

template <typename Sink>
Bsdf LightWalk<Sink>::Scatterer() {
  tracker_.Forget();  // the coefficients, which depend on the wavelengths
  return BsdfAt(context_, interaction);
}

template <typename Sink>
void LightWalk<Sink>::AddSurfaceEmission() {
  if (interaction.area_light < 0 || !CountsHit(interaction.area_light)) return;
  Add(context_.world.lights.EmittedRadiance(interaction.area_light, interaction, interaction.wo,
                                            context_.wavelengths),
      interaction.area_light);
}

template <typename Sink>
bool LightWalk<Sink>::CountsHit(int light) const {
  // Lights that cast no shadows do so where rays alone find them.
  const LightLinks& links = context_.world.links;
  if (depth_ == 0) return links.IsSeenByCamera(light);
  return links.Illuminates(light, light_links_) && (was_specular_ || !is_shadowed_);
}

template <typename Sink>
void LightWalk<Sink>::AddInfiniteEmission(int light) {
  if (!CountsHit(light)) return;
  Add(context_.world.lights.InfiniteRadiance(light, origin_, ray.d, ray.time, context_.wavelengths), light);
}

template <typename Sink>
void LightWalk<Sink>::AddInfiniteEmission() {
  for (const int light : context_.world.lights.infinite_lights()) AddInfiniteEmission(light);
}

template class LightWalk<RadianceSink>;
template class LightWalk<RecordingSink>;

}  // namespace tessera
