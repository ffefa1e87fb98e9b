// The Option directives of a scene.
#pragma once

#include <cstdint>
#include <string>

#include "renderer/accelerator/accelerator.h"
#include "renderer/description/kind_table.h"
#include "renderer/description/scene_description.h"

namespace tessera {

struct RenderOptions;

struct SceneOptions {
  uint64_t seed = 0;
  bool wavefront = false;
  float displacement_edge_scale = 1;
  bool disable_pixel_jitter = false;       // every sample is at the centre of its pixel and of the lens
  bool disable_wavelength_jitter = false;  // every sample has the same four wavelengths
  bool disable_texture_filtering = false;  // textures are looked up at points
  bool force_diffuse = false;              // surfaces are Lambertian with the albedo of their material
};

// Those of the scene with the overrides of the command line. Options that are not available are warnings,
// values that make no sense are errors.
Result<SceneOptions> ReadSceneOptions(const SceneDescription& scene, const RenderOptions& overrides,
                                      Diagnostics& diagnostics);

// Multiplies `edgelength` of every plymesh that is displaced.
void ScaleDisplacementEdges(float factor, SceneDescription& scene);

// Those that the Accelerator directive may name.
KindList SceneAcceleratorKinds();

// The accelerator to use: the one named on the command line, or the default if `option` is empty. The kind
// that the scene names is only checked, because accelerators do not change the picture.
Result<const Kind<AcceleratorMaker>*> ChooseAccelerator(const Entity& entity, const std::string& option);

}  // namespace tessera
