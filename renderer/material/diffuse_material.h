// Matte surfaces.
#pragma once

#include "renderer/bxdf/bxdf.h"
#include "renderer/material/material_reader.h"

namespace tessera {

// Parameter: spectrum texture reflectance (0.5).
struct DiffuseMaterial {
  SpectrumInput reflectance;

  static DiffuseMaterial Read(MaterialReader& reader) { return {reader.Albedo("reflectance", 0.5f)}; }
  bool ReadsTextures() const { return AnyTexture(reflectance); }
  bool IsIsotropic() const { return true; }
  Bxdf MakeBxdf(const MaterialContext& at) const { return DiffuseBxdf(Clamp(at(reflectance), 0, 1)); }
};

}  // namespace tessera
