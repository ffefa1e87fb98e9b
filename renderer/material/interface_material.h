// No surface at all: rays pass, only the medium changes.
#pragma once

#include <string_view>

#include "renderer/bxdf/bxdf.h"
#include "renderer/material/material_inputs.h"

namespace tessera {

struct InterfaceMaterial {
  // Whether scenes ask for an interface by this kind. They may also give no kind at all.
  static bool IsNamed(std::string_view kind) { return kind.empty() || kind == "interface" || kind == "none"; }

  bool ReadsTextures() const { return false; }
  bool IsIsotropic() const { return true; }
  // For integrators that do not know interfaces: absorbs all light.
  Bxdf MakeBxdf(const MaterialContext&) const { return {}; }
};

}  // namespace tessera
