// Path tracing with next-event estimation: at every vertex one light sample and one BSDF sample, weighted
// against each other by the power heuristic (Veach 1997; Pharr, Jakob, Humphreys 2023, section 13.4).
#pragma once

#include "renderer/color/wavelengths.h"
#include "renderer/integrator/world.h"
#include "renderer/math/ray.h"
#include "renderer/sampler/sampler.h"

namespace tessera {

struct PathSettings {
  int max_depth = 5;          // scattering events
  float footprint_scale = 1;  // of texture footprints, for the samples per pixel
};

// Radiance that arrives against a camera ray at `wavelengths`, which dispersion may reduce to one. Adds to
// `counts`.
SampledSpectrum PathRadiance(const World& world, const PathSettings& settings, const Ray& camera_ray,
                             SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts);

}  // namespace tessera
