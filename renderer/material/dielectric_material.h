// Glass and liquids, smooth or rough.
#pragma once

#include "renderer/bxdf/bxdf.h"
#include "renderer/material/material_reader.h"

namespace tessera {

// Parameters: float or spectrum eta (1.5); the roughness parameters of MaterialReader.
struct DielectricMaterial {
  EtaInput eta;
  RoughnessInput roughness;

  static DielectricMaterial Read(MaterialReader& reader) {
    const EtaInput eta = reader.Eta();
    return {eta, reader.Roughness()};
  }
  bool ReadsTextures() const { return AnyTexture(roughness); }
  bool IsIsotropic() const { return roughness.IsIsotropic(); }
  Bxdf MakeBxdf(const MaterialContext& at) const { return DielectricBxdf(at(roughness), at(eta)); }
};

}  // namespace tessera
