// Which integrator renders a scene, and how.
#pragma once

#include <string>

#include "renderer/description/scene_description.h"
#include "renderer/integrator/integrator_kinds.h"
#include "renderer/light/light_choice.h"
#include "renderer/scene/scene.h"

namespace tessera {

struct IntegratorChoice {
  IntegratorTraits integrator;
  std::string name;                               // of the kind
  int max_depth = 5;                              // scattering events
  bool sample_lights = true, sample_bsdf = true;  // of simplepath
  bool regularize = false;                        // of path and volpath
  LightSamplerKind light_sampler = LightSamplerKind::kTree;
};

// Reads the Integrator directive and applies the overrides of the command line. Mapped kinds are replaced,
// with a warning.
Result<IntegratorChoice> ChooseIntegrator(const SceneDescription& scene, const RenderOptions& options,
                                          Diagnostics& diagnostics);

}  // namespace tessera
