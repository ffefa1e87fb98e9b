// Whether an integrator finds all lights of a scene.
#pragma once

#include <string>
#include <vector>

#include "renderer/description/scene_description.h"
#include "renderer/integrator/estimator.h"
#include "renderer/scene/world_builder.h"
#include "renderer/util/result.h"

namespace tessera {

// Lights that no scattered ray can hit (points, directions, emitters of alpha 0 or hidden from scattered
// rays) need shadow rays. Of the integrators without shadow rays, `mixture` refuses such lights; the others
// give a warning for each. Light at infinity around a medium without a border gives a warning, too.
Result<void> CheckLightsFor(const Estimator& estimator, const SceneDescription& scene,
                            const std::vector<EmittingShape>& emitters, const World& world,
                            Diagnostics& diagnostics);

}  // namespace tessera
