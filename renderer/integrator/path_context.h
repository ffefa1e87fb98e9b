// What an integrator works with while it follows one path.
#pragma once

#include "renderer/color/wavelengths.h"
#include "renderer/integrator/world.h"
#include "renderer/sampler/sampler.h"

namespace tessera {

struct PathSettings {
  int max_depth = 5;           // scattering events
  float footprint_scale = 1;   // of texture footprints, for the samples per pixel
  bool regularize = false;     // path and volpath: surfaces after a bounce that is not specular are rougher
  bool force_diffuse = false;  // surfaces are Lambertian with the albedo of their material
};

// Rays traced, by kind.
struct RayCounts {
  uint64_t camera = 0, bounce = 0, shadow = 0;
};

// References to what outlives the path: cheap to copy.
struct PathContext {
  const World& world;
  const PathSettings& settings;
  SampledWavelengths& wavelengths;  // dispersion may reduce them to one
  Sampler& sampler;
  RayCounts& counts;
};

}  // namespace tessera
