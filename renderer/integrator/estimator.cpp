#include "renderer/integrator/estimator.h"

#include "renderer/integrator/mixture_integrator.h"
#include "renderer/integrator/random_walk_integrator.h"
#include "renderer/integrator/simple_path_integrator.h"
#include "renderer/integrator/volume_path_integrator.h"

namespace tessera {

SampledSpectrum EstimateRadiance(const World& world, const Estimator& estimator, const Ray& camera_ray,
                                 SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts) {
  const PathSettings& path = estimator.path;
  switch (estimator.integrator.kind) {
    case IntegratorKind::kVolPath:
      // Without media both integrators make the same picture, and the simple one makes it faster.
      if (!world.media.empty())
        return VolumePathRadiance(world, path, camera_ray, wavelengths, sampler, counts);
      [[fallthrough]];
    case IntegratorKind::kPath: return PathRadiance(world, path, camera_ray, wavelengths, sampler, counts);
    case IntegratorKind::kMixture:
      return MixtureRadiance(world, *estimator.lights, path, camera_ray, wavelengths, sampler, counts);
    case IntegratorKind::kSimplePath:
      return SimplePathRadiance(world, {path, estimator.sample_lights, estimator.sample_bsdf}, camera_ray,
                                wavelengths, sampler, counts);
    case IntegratorKind::kSimpleVolPath:
      return SimplePathRadiance(world, {path, false, true}, camera_ray, wavelengths, sampler, counts);
    case IntegratorKind::kRandomWalk:
      return RandomWalkRadiance(world, path, camera_ray, wavelengths, sampler, counts);
  }
  return SampledSpectrum(0.0f);
}

}  // namespace tessera
