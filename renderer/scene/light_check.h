// Whether an integrator finds all lights of a scene.
#pragma once

#include <string>
#include <vector>

#include "renderer/description/scene_description.h"
#include "renderer/integrator/estimator.h"
#include "renderer/scene/world_builder.h"
#include "renderer/util/result.h"

namespace tessera {

// Lights that no ray can hit (points, directions, emitters of alpha 0) need shadow rays. Of the integrators
// without shadow rays, `mixture` refuses such lights; the others give a warning for each.
Result<void> CheckLightsFor(const Estimator& estimator, const SceneDescription& scene,
                            const std::vector<EmittingShape>& emitters, const World& world,
                            Diagnostics& diagnostics);

}  // namespace tessera
