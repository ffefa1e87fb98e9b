// The simplest estimator: at every surface a direction uniform over the sphere, emission where rays hit it,
// no light sampling, no roulette. Slow, but hard to get wrong: a check for the others. Specular surfaces,
// whose lobes uniform directions never hit, stay black.
#pragma once

#include "renderer/integrator/sample_record.h"

namespace tessera {

// As TracePath.
template <typename Sink>
void TraceRandomWalk(const PathContext& context, const Ray& camera_ray, Sink& sink);

}  // namespace tessera
