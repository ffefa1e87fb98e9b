// Metals, smooth or rough.
#pragma once

#include "renderer/bxdf/bxdf.h"
#include "renderer/material/material_reader.h"

namespace tessera {

// Parameters: spectrum textures eta and k (of copper), or reflectance at normal incidence in their place; the
// roughness parameters of MaterialReader.
struct ConductorMaterial {
  bool has_reflectance = false;  // then `eta` is the reflectance at normal incidence and `k` is unused
  SpectrumInput eta, k;
  RoughnessInput roughness;

  static ConductorMaterial Read(MaterialReader& reader);
  bool ReadsTextures() const { return AnyTexture(eta, k, roughness); }
  Bxdf MakeBxdf(const MaterialContext& at) const;
};

}  // namespace tessera
