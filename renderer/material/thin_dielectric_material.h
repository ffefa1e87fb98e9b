// Panes of glass without thickness.
#pragma once

#include "renderer/bxdf/bxdf.h"
#include "renderer/material/material_reader.h"

namespace tessera {

// Parameter: float or spectrum eta (1.5).
struct ThinDielectricMaterial {
  EtaInput eta;

  static ThinDielectricMaterial Read(MaterialReader& reader) { return {reader.Eta()}; }
  bool ReadsTextures() const { return false; }
  bool IsIsotropic() const { return true; }
  Bxdf MakeBxdf(const MaterialContext& at) const { return ThinDielectricBxdf(at(eta)); }
};

}  // namespace tessera
