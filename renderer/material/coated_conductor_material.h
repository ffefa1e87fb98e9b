// Metals under a clear coat: car paint, lacquered brass.
#pragma once

#include "renderer/bxdf/bxdf.h"
#include "renderer/material/coat_layer_input.h"
#include "renderer/material/conductor_input.h"
#include "renderer/material/material_reader.h"

namespace tessera {

// Parameters: those of CoatLayerInput and, with the prefix "conductor.", of ConductorInput; float or spectrum
// interface.eta (1.5); the roughness parameters of MaterialReader with the prefixes "interface." and
// "conductor.", and one remaproughness for both.
struct CoatedConductorMaterial {
  ConductorInput metal;
  RoughnessInput metal_roughness, coat_roughness;
  EtaInput eta;
  CoatLayerInput layer;

  static CoatedConductorMaterial Read(MaterialReader& reader);
  bool ReadsTextures() const { return AnyTexture(metal, metal_roughness, coat_roughness, layer); }
  bool IsIsotropic() const { return metal_roughness.IsIsotropic() && coat_roughness.IsIsotropic(); }
  Bxdf MakeBxdf(const MaterialContext& at) const;
};

}  // namespace tessera
