// What the vertices of all path tracers have in common: the reference for light sampling, the Bsdf, one
// sampled light, densities of light sampling, Russian roulette.
#pragma once

#include <algorithm>
#include <optional>

#include "renderer/integrator/path_integrator.h"
#include "renderer/integrator/texture_context.h"

namespace tessera {

// Interfaces without scattering in between: more are a ray caught in rounding errors.
constexpr int kInterfacesMax = 1000;

inline ReferencePoint ReferenceAt(const SurfaceInteraction& interaction) {
  return {interaction.p, interaction.p_error, interaction.n, interaction.shading.n};
}

// May change the shading normal and drop wavelengths.
inline Bsdf BsdfAt(const World& world, const PathSettings& settings, SurfaceInteraction& interaction,
                   SampledWavelengths& wavelengths) {
  const TextureContext context = world.materials.NeedsFootprint(interaction.material)
                                     ? MakeTextureContext(interaction, world.camera, settings.footprint_scale)
                                     : PlaceOf(interaction);
  return world.materials.Evaluate(interaction.material, world.textures, context, interaction, wavelengths);
}

struct SampledLight {
  LightSample light;
  float pdf = 0;  // per solid angle, with the probability of choosing this light
};

// Light towards a point from one light. Takes three dimensions of the sampler. Nothing if none arrives.
inline std::optional<SampledLight> SampleOneLight(const World& world, const ReferencePoint& reference,
                                                  const SampledWavelengths& wavelengths, Sampler& sampler) {
  const float u_choice = sampler.Get1D();
  const Point2 u_light = sampler.Get2D();
  const std::optional<ChosenLight> chosen = world.lights.Choose(reference, u_choice);
  if (!chosen) return std::nullopt;
  const std::optional<LightSample> light =
      world.lights.Sample(chosen->light, reference, u_light, wavelengths);
  if (!light || light->pdf <= 0 || !AnyNonZero(light->L)) return std::nullopt;
  return SampledLight{*light, chosen->pmf * light->pdf};
}

// The densities with which SampleOneLight finds what a ray along wi hits.
inline float EmitterPdf(const World& world, const ReferencePoint& reference, Vec3 wi,
                        const SurfaceInteraction& emitter) {
  const float choice = world.lights.ChoosePmf(reference, emitter.area_light);
  if (choice == 0) return 0;
  return choice * world.lights.AreaLightPdf(emitter.area_light, reference, wi, emitter);
}
inline float InfiniteLightPdf(const World& world, const ReferencePoint& reference, Vec3 wi, int light) {
  return world.lights.ChoosePmf(reference, light) * world.lights.InfiniteLightPdf(light, wi);
}

// The probability of ending a path that is expected to bring `expected` of what it would find; 0 before its
// second vertex.
inline float EndProbability(float expected, int depth) {
  if (depth <= 1 || !(expected < 1)) return 0;
  return std::max(0.0f, 1 - expected);
}

}  // namespace tessera
