// An integrator with its settings, and the radiance that it estimates.
#pragma once

#include <optional>

#include "renderer/integrator/integrator_kinds.h"
#include "renderer/integrator/light_directions.h"
#include "renderer/integrator/path_integrator.h"
#include "renderer/integrator/world.h"

namespace tessera {

struct Estimator {
  IntegratorTraits integrator;
  PathSettings path;
  bool sample_lights = true, sample_bsdf = true;  // of simplepath
  std::optional<LightDirections> lights;          // of mixture: for the same world
};

// Radiance that arrives against a camera ray at `wavelengths`, which dispersion may reduce to one. Adds to
// `counts`.
SampledSpectrum EstimateRadiance(const World& world, const Estimator& estimator, const Ray& camera_ray,
                                 SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts);

}  // namespace tessera
