// The ways to estimate a picture, by name. All converge to the same one where each is valid; they differ in
// noise and speed.
#pragma once

#include <optional>
#include <string_view>

#include "renderer/integrator/light_directions.h"
#include "renderer/integrator/path_integrator.h"
#include "renderer/integrator/world.h"

namespace tessera {

//   path           light sampling and BSDF sampling at every vertex, weighted against each other; roulette
//   volpath        the same, in participating media too
//   mixture        one ray per vertex, drawn from BSDF and lights together (mixture_integrator.h)
//   simplepath     one technique at a time (simple_path_integrator.h)
//   simplevolpath  BSDF sampling, emission where rays hit it
//   randomwalk     uniform directions, emission where rays hit it
enum class IntegratorKind { kPath, kVolPath, kMixture, kSimplePath, kSimpleVolPath, kRandomWalk };

// The kind of this name, if it is one.
std::optional<IntegratorKind> IntegratorNamed(std::string_view name);

struct Estimator {
  IntegratorKind kind = IntegratorKind::kPath;
  PathSettings path;
  bool sample_lights = true, sample_bsdf = true;  // of simplepath
  std::optional<LightDirections> lights;          // of mixture: for the same world
};

// Radiance that arrives against a camera ray at `wavelengths`, which dispersion may reduce to one. Adds to
// `counts`.
SampledSpectrum EstimateRadiance(const World& world, const Estimator& estimator, const Ray& camera_ray,
                                 SampledWavelengths& wavelengths, Sampler& sampler, RayCounts& counts);

}  // namespace tessera
