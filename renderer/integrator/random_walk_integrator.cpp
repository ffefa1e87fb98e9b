#include "integrator/random_walk_integrator.h"

#include "integrator/emission_on_hit.h"
#include "integrator/texture_context.h"
#include "math/sampling.h"

namespace tessera {

SampledSpectrum RandomWalkRadiance(const World& world, const PathSettings& settings, const Ray& camera_ray,
                                   SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts) {
  SampledSpectrum radiance(0.0f), throughput(1.0f);
  Ray ray = camera_ray;
  for (int depth = 0;; ++depth) {
    auto interaction = FollowRay(world, ray, depth == 0 ? counts.camera : counts.bounce);
    if (!interaction) return radiance + throughput * EmissionBeyond(world, ray.d, wavelengths);
    radiance += throughput * EmissionAt(world, *interaction, wavelengths);
    if (depth == settings.max_depth) return radiance;
    const TextureContext context = MakeTextureContext(*interaction, world.camera, settings.footprint_scale);
    const Bsdf bsdf =
        world.materials.Evaluate(interaction->material, world.textures, context, *interaction, wavelengths);
    const Vec3 wi = SampleUniformSphere(sampler.Get2D());
    const SampledSpectrum f = bsdf.Evaluate(interaction->wo, wi).f;
    if (!AnyNonZero(f)) return radiance;
    throughput *= f * (AbsDot(wi, interaction->shading.n) / UniformSpherePdf());
    ray = interaction->SpawnRay(wi);
  }
}

}  // namespace tessera
