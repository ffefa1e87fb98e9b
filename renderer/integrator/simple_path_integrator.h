// A path tracer of one technique at a time: light is found either by shadow rays to sampled lights or by rays
// that happen to hit it, never by both weighted against each other. With light sampling off it is classic
// distributed ray tracing. No roulette. (pbrt-v4's SimplePathIntegrator has the same switches.)
#pragma once

#include "renderer/color/wavelengths.h"
#include "renderer/integrator/path_integrator.h"
#include "renderer/integrator/world.h"

namespace tessera {

struct SimplePathSettings {
  PathSettings path;
  bool sample_lights = true;  // else: emission counts wherever a ray hits it
  bool sample_bsdf =
      true;  // else: directions uniform over the sphere or hemisphere; specular lobes are black
};

// As PathRadiance.
SampledSpectrum SimplePathRadiance(const World& world, const SimplePathSettings& settings,
                                   const Ray& camera_ray, SampledWavelengths& wavelengths, Sampler& sampler,
                                   RayCounts& counts);

}  // namespace tessera
