// Measured scattering properties of everyday materials, by name.
#pragma once

#include <span>
#include <string_view>

#include "renderer/math/vec.h"

namespace tessera {

struct ScatteringPreset {
  std::string_view name;
  Vec3 sigma_s;  // linear sRGB, per mm; reduced: with isotropic scattering
  Vec3 sigma_a;  // linear sRGB, per mm
};

// All presets, in the order of their sources.
std::span<const ScatteringPreset> ScatteringPresets();
// Returns null if the name is unknown.
const ScatteringPreset* FindScatteringPreset(std::string_view name);

}  // namespace tessera
