// Matte surfaces that also transmit light: paper, leaves.
#pragma once

#include "renderer/bxdf/bxdf.h"
#include "renderer/material/material_reader.h"

namespace tessera {

// Parameters: spectrum textures reflectance (0.25) and transmittance (0.25), float scale (1) of both.
struct DiffuseTransmissionMaterial {
  SpectrumInput reflectance, transmittance;
  float scale = 1;

  static DiffuseTransmissionMaterial Read(MaterialReader& reader);
  bool ReadsTextures() const { return AnyTexture(reflectance, transmittance); }
  bool IsIsotropic() const { return true; }
  Bxdf MakeBxdf(const MaterialContext& at) const;
};

}  // namespace tessera
