// Metals, smooth or rough.
#pragma once

#include "renderer/bxdf/bxdf.h"
#include "renderer/material/conductor_input.h"
#include "renderer/material/material_reader.h"

namespace tessera {

// Parameters: those of ConductorInput, and the roughness parameters of MaterialReader.
struct ConductorMaterial {
  ConductorInput metal;
  RoughnessInput roughness;

  static ConductorMaterial Read(MaterialReader& reader) {
    const ConductorInput metal = ConductorInput::Read(reader);
    return {metal, reader.Roughness()};
  }
  bool ReadsTextures() const { return AnyTexture(metal, roughness); }
  bool IsIsotropic() const { return roughness.IsIsotropic(); }
  Bxdf MakeBxdf(const MaterialContext& at) const {
    const ConductorIndex index = metal.Evaluate(at);
    return ConductorBxdf(at(roughness), index.eta, index.k);
  }
};

}  // namespace tessera
