#include "renderer/integrator/light_walk.h"

#include <algorithm>

#include "renderer/integrator/path_vertex.h"
#include "renderer/shape/shape_interaction.h"

namespace tessera {

LightWalk::LightWalk(const World& world, const Ray& camera_ray, SampledWavelengths& wavelengths,
                     RayCounts& counts)
    : ray(camera_ray),
      world_(world),
      wavelengths_(wavelengths),
      counts_(counts),
      tracker_(world, wavelengths, counts),
      medium_(world.camera_medium) {}

LightWalk::Event LightWalk::Advance(Sampler& sampler) {
  for (int interfaces = 0; interfaces < kInterfacesMax; ++interfaces) {
    ++(left_camera_ ? counts_.bounce : counts_.camera);
    Hit hit;
    const bool found = world_.accelerator->Intersect(ray, &hit);
    if (medium_ >= 0 && Collides(found ? hit.t : kFlightMax, sampler)) {
      in_medium_ = true;
      return Event::kInMedium;
    }
    if (!found) return Event::kEscaped;
    interaction = MakeInteraction(world_.geometry, hit, ray);
    if (!world_.materials.IsInterface(interaction.material)) {
      in_medium_ = false;
      return Event::kOnSurface;
    }
    medium_ = MediumTracker::Beyond(interaction, ray.d, medium_);
    ray = interaction.SpawnRay(ray.d);
  }
  throughput = SampledSpectrum(0.0f);  // caught in rounding errors
  return Event::kEscaped;
}

bool LightWalk::Collides(float t_max, Sampler& sampler) {
  const float u = sampler.Get1D() * 4;
  const int deciding = std::min(static_cast<int>(u), 3);
  const MediumCoefficients& medium = tracker_.In(medium_);
  const SampledSpectrum sigma_t = medium.sigma_a + medium.sigma_s;
  if (AnyNonZero(medium.emission)) radiance += throughput * medium.emission * IntegralOfExp(sigma_t, t_max);
  const float t = SampleExponential(u - static_cast<float>(deciding), medium.sigma_s[deciding]);
  if (t < t_max) {
    const float pdf = Average(medium.sigma_s * Exp(medium.sigma_s * -t));
    throughput *= medium.sigma_s * Exp(sigma_t * -t) * (1 / pdf);
    ray.o = ray.At(t);
    return true;
  }
  const float probability = Average(Exp(medium.sigma_s * -t_max));
  throughput =
      probability > 0 ? throughput * Exp(sigma_t * -t_max) * (1 / probability) : SampledSpectrum(0.0f);
  return false;
}

void LightWalk::Leave(const Ray& next, SampledSpectrum weight) {
  throughput *= weight;
  left_camera_ = true;
  ray = next;
  if (!in_medium_) medium_ = MediumTracker::Beyond(interaction, ray.d, medium_);
}

Bsdf LightWalk::Scatterer(const PathSettings& settings) {
  tracker_.Forget();  // the coefficients, which depend on the wavelengths
  return BsdfAt(world_, settings, interaction, wavelengths_);
}

void LightWalk::AddSurfaceEmission() {
  if (interaction.area_light < 0) return;
  radiance += throughput * world_.lights.EmittedRadiance(interaction.area_light, interaction, interaction.wo,
                                                         wavelengths_);
}

void LightWalk::AddInfiniteEmission() {
  for (const int light : world_.lights.infinite_lights())
    radiance += throughput * world_.lights.InfiniteRadiance(light, ray.d, wavelengths_);
}

}  // namespace tessera
