// The plainest estimator: at every surface a direction uniform over the sphere, emission where rays hit it,
// no light sampling, no roulette. Slow, but hard to get wrong: a check for the others. Specular surfaces,
// which it cannot hit the lobes of, stay black.
#pragma once

#include "renderer/color/wavelengths.h"
#include "renderer/integrator/path_integrator.h"
#include "renderer/integrator/world.h"

namespace tessera {

// As PathRadiance.
SampledSpectrum RandomWalkRadiance(const World& world, const PathSettings& settings, const Ray& camera_ray,
                                   SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts);

}  // namespace tessera
