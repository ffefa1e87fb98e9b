#include "renderer/integrator/random_walk_integrator.h"

#include "renderer/integrator/light_walk.h"
#include "renderer/math/sampling.h"

namespace tessera {

SampledSpectrum RandomWalkRadiance(const World& world, const PathSettings& settings, const Ray& camera_ray,
                                   SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts) {
  LightWalk walk(world, camera_ray, wavelengths, counts);
  for (int depth = 0;; ++depth) {
    const LightWalk::Event event = walk.Advance(sampler);
    if (event == LightWalk::Event::kEscaped) walk.AddInfiniteEmission();
    if (event == LightWalk::Event::kOnSurface) walk.AddSurfaceEmission();
    if (event == LightWalk::Event::kEscaped || depth == settings.max_depth) return walk.radiance;
    const Vec3 wi = SampleUniformSphere(sampler.Get2D());
    const SampledSpectrum f = walk.Scatterer(settings).Evaluate(walk.interaction.wo, wi).f;
    if (!AnyNonZero(f)) return walk.radiance;
    const float cosine = AbsDot(wi, walk.interaction.shading.n);
    walk.Leave(walk.interaction.SpawnRay(wi), f * (cosine / UniformSpherePdf()));
  }
}

}  // namespace tessera
