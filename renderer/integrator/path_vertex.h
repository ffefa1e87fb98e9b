// What the vertices of all path tracers share: the reference point for light sampling, the BSDF, one sampled
// light, the densities of light sampling, Russian roulette.
#pragma once

#include <algorithm>
#include <optional>

#include "renderer/integrator/path_context.h"
#include "renderer/integrator/texture_context.h"

namespace tessera {

// Interfaces crossed without scattering in between. A ray that crosses more is caught in rounding errors.
constexpr int kInterfacesMax = 1000;

inline ReferencePoint ReferenceAt(const SurfaceInteraction& interaction) {
  return {interaction.p,         interaction.p_error, interaction.n,
          interaction.shading.n, interaction.time,    interaction.light_links};
}

// The point that `bsdf` is lit at. Rays leave a curve from outside its width. What scatters light of one side
// only is lit where the rays of that side start, as in pbrt: near lights are elsewhere than seen from the
// axis.
//
// Written member by member: the copy of a reference point waits for the stores of its parts.
inline void SetReference(const SurfaceInteraction& interaction, const Bsdf& bsdf, ReferencePoint* reference) {
  reference->p = interaction.p;
  reference->p_error = interaction.p_error;
  reference->n = interaction.n;
  reference->shading_n = interaction.shading.n;
  reference->time = interaction.time;
  reference->light_links = interaction.light_links;
  reference->lobe = bsdf.Lobe(interaction.wo);
  if (!interaction.faces_rays) return;
  const bool reflects = HasFlag(bsdf.flags(), BxdfFlags::kReflection);
  if (reflects == HasFlag(bsdf.flags(), BxdfFlags::kTransmission)) return;
  reference->p = OffsetRayOrigin(interaction.p, interaction.p_error, interaction.n,
                                 reflects ? interaction.wo : -interaction.wo);
  reference->p_error = {};
}
inline ReferencePoint ReferenceAt(const SurfaceInteraction& interaction, const Bsdf& bsdf) {
  ReferencePoint reference;
  SetReference(interaction, bsdf, &reference);
  return reference;
}

// A Lambertian surface with the albedo of another, estimated from one sample. Takes three dimensions of the
// sampler.
inline Bsdf DiffuseEquivalent(const PathContext& context, const SurfaceInteraction& interaction,
                              const Bsdf& bsdf) {
  const float u_component = context.sampler.Get1D();
  const Point2 u_direction = context.sampler.Get2D();
  const std::optional<BsdfSample> sample = bsdf.Sample(interaction.wo, u_component, u_direction);
  SampledSpectrum albedo(0.0f);
  if (sample) albedo = sample->f * (AbsDot(sample->wi, interaction.shading.n) / sample->pdf);
  return Bsdf(interaction.shading.n, DiffuseBxdf(albedo));
}

// May change the shading normal and drop wavelengths.
inline Bsdf BsdfAt(const PathContext& context, SurfaceInteraction& interaction, bool regularizes = false) {
  const World& world = context.world;
  const TextureContext place =
      world.materials.NeedsFootprint(interaction.material)
          ? MakeTextureContext(interaction, world.camera, context.settings.footprint_scale)
          : PlaceOf(interaction);
  Bsdf bsdf = world.materials.Evaluate(interaction.material, world.textures, place, interaction,
                                       context.wavelengths, regularizes);
  if (context.settings.force_diffuse) bsdf = DiffuseEquivalent(context, interaction, bsdf);
  return bsdf;
}

// For an interaction that BsdfAt has seen, where ScattersBelow.
inline std::optional<Subsurface> SubsurfaceAt(const PathContext& context,
                                              const SurfaceInteraction& interaction) {
  const World& world = context.world;
  const TextureContext place =
      world.materials.NeedsFootprint(interaction.material)
          ? MakeTextureContext(interaction, world.camera, context.settings.footprint_scale)
          : PlaceOf(interaction);
  return world.materials.SubsurfaceAt(interaction.material, world.textures, place, interaction,
                                      context.wavelengths);
}

struct SampledLight {
  int index = 0;  // into World::lights
  LightSample light;
  float pdf = 0;  // per solid angle, with the probabilities of sampling a light and of choosing this one
  bool casts_shadows = true;
};

// Heeds LightLinks. `from`: where the shadow ray leaves the surface. Returns false if the light does not
// illuminate the point. Sets is_delta if light sampling alone finds the light there, whatever scattered rays
// hit.
bool FollowLink(const PathContext& context, const ReferencePoint& from, SampledLight& sampled);

// Samples the chosen light as seen from `reference`, regardless of links. Returns nullopt if nothing arrives.
inline std::optional<SampledLight> SampleLight(const PathContext& context, const ChosenLight& chosen,
                                               const ReferencePoint& reference, Point2 u) {
  const std::optional<LightSample> light =
      context.world.lights.Sample(chosen.light, reference, u, context.wavelengths);
  if (!light || light->pdf <= 0 || light->IsDark()) return std::nullopt;
  return SampledLight{chosen.light, *light, chosen.pmf * light->pdf};
}

// Samples one light as seen from `reference` with probability `share`, regardless of links. Takes three
// dimensions of the sampler. Returns nullopt if no light is sampled or none arrives.
inline std::optional<SampledLight> SampleAnyLight(const PathContext& context, const ReferencePoint& reference,
                                                  float share) {
  float u_choice = context.sampler.Get1D();
  const Point2 u_light = context.sampler.Get2D();
  if (u_choice >= share) return std::nullopt;
  u_choice = std::min(u_choice / share, kOneMinusEpsilon);
  const std::optional<ChosenLight> chosen = context.world.lights.Choose(reference, u_choice);
  if (!chosen) return std::nullopt;
  std::optional<SampledLight> sampled = SampleLight(context, *chosen, reference, u_light);
  if (sampled) sampled->pdf *= share;
  return sampled;
}
// The same with the links of `reference`, where the shadow ray starts.
inline std::optional<SampledLight> SampleOneLight(const PathContext& context, const ReferencePoint& reference,
                                                  float share = 1) {
  std::optional<SampledLight> sampled = SampleAnyLight(context, reference, share);
  if (sampled && context.world.links.any() && !FollowLink(context, reference, *sampled)) sampled.reset();
  return sampled;
}
// The same for a shadow ray that starts at `surface`.
inline std::optional<SampledLight> SampleOneLight(const PathContext& context, const ReferencePoint& reference,
                                                  const SurfaceInteraction& surface, float share = 1) {
  std::optional<SampledLight> sampled = SampleAnyLight(context, reference, share);
  if (sampled && context.world.links.any() && !FollowLink(context, ReferenceAt(surface), *sampled))
    sampled.reset();
  return sampled;
}

// Whether a ray passes the surface, after `depth` scattering events.
inline bool IsHidden(const SurfaceInteraction& interaction, int depth) {
  return (interaction.hidden_from & (depth == 0 ? kHiddenFromCamera : kHiddenFromIndirect)) != 0;
}

// The ray that hits a light.
struct LightHit {
  int depth = 0;                          // scattering events before
  bool is_specular = false;               // the last of them
  bool is_shadowed = false;               // it has passed hidden surfaces that cast shadows since then
  uint64_t light_links = kAllLightLinks;  // of where it was
};

// Whether the light that a ray hits is part of the path's radiance. Light sampling has all light of lights
// that cast no shadows, and none of what hidden surfaces keep from a point; specular surfaces mirror both.
inline bool HitCounts(const LightLinks& links, int light, const LightHit& hit) {
  if (hit.depth == 0) return links.IsSeenByCamera(light);
  if (!links.Illuminates(light, hit.light_links)) return false;
  return hit.is_specular || (!hit.is_shadowed && links.CastsShadows(light));
}

// A ray from a surface point to a sampled light.
inline Ray ShadowRay(const SurfaceInteraction& from, const LightSample& light) {
  return SpawnRayTo(from.p, from.p_error, from.n, light.p, light.p_error, light.n, from.time);
}

// The density that stands for two other techniques in the power heuristic.
inline float Combined(float a, float b) {
  return b == 0 ? a : std::sqrt(a * a + b * b);
}

// The densities with which SampleOneLight finds what a ray along wi hits, if its share is `share`, or 1. That
// of an emitter includes another technique, which finds the reference point and the light with
// `place_density` times the density of the point.
inline float EmitterPdf(const World& world, const ReferencePoint& reference, Vec3 wi,
                        const SurfaceInteraction& emitter, float share = 1, float place_density = 0) {
  const float choice = Combined(share * world.lights.ChoosePmf(reference, emitter.area_light), place_density);
  if (choice == 0) return 0;
  return choice * world.lights.AreaLightPdf(emitter.area_light, reference, wi, emitter);
}
inline float InfiniteLightPdf(const World& world, const ReferencePoint& reference, Vec3 wi, int light) {
  return world.lights.ChoosePmf(reference, light) *
         world.lights.InfiniteLightPdf(light, reference.p, wi, reference.time);
}

// Paths that carry at least this share of the radiance that they find never end by chance. To end them
// earlier saves fewer rays than the larger weights of survivors cost in variance.
constexpr float kSureShare = 0.25f;

// The probability of ending a path whose next ray is expected to bring the share `expected` of the radiance
// that it finds; 0 before the second vertex.
inline float EndProbability(float expected, int depth) {
  if (depth <= 1 || !(expected < kSureShare)) return 0;
  return 1 - std::max(0.0f, expected / kSureShare);
}

// Whether a direction that was sampled with this density (per steradian) finds lights that light sampling
// hardly finds. Roulette is then put off to the next vertex: the few paths that survive it would make bright
// pixels of lights that are mirrored in dark or in faintly reflecting surfaces.
constexpr float kSharpDensity = 10;
inline bool IsSharp(float density) {
  return density > kSharpDensity;
}

}  // namespace tessera
