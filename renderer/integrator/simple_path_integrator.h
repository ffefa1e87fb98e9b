// A path tracer of one technique at a time: light is found either by shadow rays to sampled lights or by rays
// that happen to hit it, never by both weighted against each other. With light sampling off it is classic
// distributed ray tracing. There is no roulette. (pbrt-v4's SimplePathIntegrator has the same switches.)
#pragma once

#include "renderer/integrator/sample_record.h"

namespace tessera {

struct SimplePathTechniques {
  // If not: emission counts wherever a ray hits it.
  bool sample_lights = true;
  // If not: directions are uniform over the sphere or hemisphere, and specular lobes are black.
  bool sample_bsdf = true;
};

// As TracePath.
template <typename Sink>
void TraceSimplePath(const PathContext& context, SimplePathTechniques techniques, const Ray& camera_ray,
                     Sink& sink);

}  // namespace tessera
