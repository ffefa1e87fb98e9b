// Path tracing with next-event estimation: at every vertex, on a surface or in a medium, one light sample and
// one sampled direction, weighted against each other by the power heuristic (Veach 1997; Pharr, Jakob,
// Humphreys 2023, sections 13.4 and 14.2). What counts as scattering is what pbrt-v4's `volpath` counts.
#pragma once

#include "renderer/integrator/light_visibility.h"
#include "renderer/integrator/sample_record.h"
#include "renderer/math/ray.h"

namespace tessera {

// Follows one path from the camera and reports it to `sink`. Rays are in a vacuum everywhere. Where lights
// are hidden according to `visibility`, which may be null, they are sampled less often.
template <typename Sink>
void TracePath(const PathContext& context, const LightVisibility* visibility, const Ray& camera_ray,
               Sink& sink);

// The same where the world has media. Not to the same bits, and slower, where it has none.
template <typename Sink>
void TraceVolumePath(const PathContext& context, const LightVisibility* visibility, const Ray& camera_ray,
                     Sink& sink);

}  // namespace tessera
