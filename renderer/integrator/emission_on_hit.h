// What estimators without light sampling do: follow a ray, and add the light that it meets.
#pragma once

#include <optional>

#include "integrator/world.h"
#include "shape/shape_interaction.h"

namespace tessera {

// The surface that scatters or emits which `ray` meets first, passing `interface` surfaces; `ray` is moved to
// the last of them. Nothing if it leaves the scene. Counts every ray in `count`.
inline std::optional<SurfaceInteraction> FollowRay(const World& world, Ray& ray, uint64_t& count) {
  constexpr int kInterfacesMax = 1000;  // more without scattering in between: a ray caught in rounding errors
  for (int i = 0; i <= kInterfacesMax; ++i) {
    Hit hit;
    ++count;
    if (!world.accelerator->Intersect(ray, &hit)) return std::nullopt;
    SurfaceInteraction interaction = MakeInteraction(world.geometry, hit, ray);
    if (!world.materials.IsInterface(interaction.material)) return interaction;
    ray = interaction.SpawnRay(ray.d);
  }
  return std::nullopt;
}

// Radiance that a surface emits along wo.
inline SampledSpectrum EmissionAt(const World& world, const SurfaceInteraction& interaction,
                                  const SampledWavelengths& wavelengths) {
  if (interaction.area_light < 0) return SampledSpectrum(0.0f);
  return world.lights.EmittedRadiance(interaction.area_light, interaction, interaction.wo, wavelengths);
}

// Radiance of all lights at infinity against unit direction d.
inline SampledSpectrum EmissionBeyond(const World& world, Vec3 d, const SampledWavelengths& wavelengths) {
  SampledSpectrum sum(0.0f);
  for (const int light : world.lights.infinite_lights())
    sum += world.lights.InfiniteRadiance(light, d, wavelengths);
  return sum;
}

}  // namespace tessera
