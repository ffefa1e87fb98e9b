// An integrator with its settings, and the radiance that it estimates.
#pragma once

#include <memory>
#include <optional>

#include "renderer/integrator/integrator_kinds.h"
#include "renderer/integrator/light_directions.h"
#include "renderer/integrator/light_visibility.h"
#include "renderer/integrator/plain_surfaces.h"
#include "renderer/integrator/sample_record.h"
#include "renderer/integrator/simple_path_integrator.h"

namespace tessera {

struct Estimator {
  IntegratorTraits integrator;
  PathSettings path;
  SimplePathTechniques techniques;        // of simplepath
  std::optional<LightDirections> lights;  // of mixture: for the same world
  // Of path and volpath, for the same world; null: lights are sampled everywhere.
  std::unique_ptr<LightVisibility> visibility;

  // The surfaces of the same world whose vertices a PathBatch computes together; null: it follows no paths.
  std::unique_ptr<const PlainSurfaces> plain;

  bool HasShadowRays() const { return integrator.has_shadow_rays && techniques.sample_lights; }
};

// Radiance that arrives against a camera ray, per wavelength: to be divided by the densities that the
// wavelengths have afterwards. The settings of `context` are those of `estimator`.
SampledSpectrum EstimateRadiance(const PathContext& context, const Estimator& estimator,
                                 const Ray& camera_ray);

// The same to the last bit, with the parts that it consists of reported to `recorder`.
SampledSpectrum EstimateRadiance(const PathContext& context, const Estimator& estimator,
                                 const Ray& camera_ray, SampleRecorder& recorder);

}  // namespace tessera
