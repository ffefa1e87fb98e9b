// What a metal reflects, as materials describe it.
#pragma once

#include <string>

#include "renderer/material/material_inputs.h"
#include "renderer/material/material_reader.h"

namespace tessera {

// The complex index of refraction eta + i k of a metal relative to vacuum.
struct ConductorIndex {
  SampledSpectrum eta, k;
};

// Parameters: spectrum textures PREFIXeta and PREFIXk (of copper), or reflectance at normal incidence in
// their place.
struct ConductorInput {
  bool has_reflectance = false;  // then `eta` is the reflectance at normal incidence and `k` is unused
  SpectrumInput eta, k;

  static ConductorInput Read(MaterialReader& reader, const std::string& prefix = "");
  bool IsConstant() const { return !AnyTexture(eta, k); }
  ConductorIndex Evaluate(const MaterialContext& at) const;
};

}  // namespace tessera
