// Which integrator renders a scene, and how.
#pragma once

#include <string>
#include <vector>

#include "renderer/description/scene_description.h"
#include "renderer/scene/scene.h"

namespace tessera {

struct IntegratorChoice {
  std::string name;                               // of an IntegratorKind: what is done
  int max_depth = 5;                              // scattering events
  bool sample_lights = true, sample_bsdf = true;  // of simplepath
  std::string light_sampler = "bvh";
};

// Reads the Integrator directive with the command line's overrides. Integrators that estimate the same
// picture in another way are replaced by ours, with a warning.
Result<IntegratorChoice> ChooseIntegrator(const SceneDescription& scene, const RenderOptions& options,
                                          Diagnostics& diagnostics);

}  // namespace tessera
