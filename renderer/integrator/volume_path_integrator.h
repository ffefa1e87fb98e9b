// Path tracing through media: at every vertex, on a surface or in a medium, one light sample and one sampled
// direction, weighted against each other and between the wavelengths (medium/flight.h). Follows pbrt-v4's
// `volpath` in what counts as scattering.
#pragma once

#include "renderer/integrator/path_integrator.h"

namespace tessera {

// As PathRadiance; the world may have media. Slower than it where there are none.
SampledSpectrum VolumePathRadiance(const World& world, const PathSettings& settings, const Ray& camera_ray,
                                   SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts);

}  // namespace tessera
