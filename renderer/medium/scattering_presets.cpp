#include "renderer/medium/scattering_presets.h"

namespace tessera {

const ScatteringPreset* FindScatteringPreset(std::string_view name) {
  for (const ScatteringPreset& preset : ScatteringPresets()) {
    if (preset.name == name) return &preset;
  }
  return nullptr;
}

}  // namespace tessera
