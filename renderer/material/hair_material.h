// Hair and fur.
#pragma once

#include <optional>

#include "renderer/bxdf/bxdf.h"
#include "renderer/material/material_reader.h"

namespace tessera {

// Parameters: the absorption inside by one of: spectrum texture sigma_a; spectrum texture reflectance, also
// called color; float textures eumelanin and pheomelanin (1.3 and 0 if nothing is given). Float textures eta
// (1.55), beta_m (0.3), beta_n (0.3) and alpha (2 degrees). The v coordinate of the surface runs across the
// width of the hair. No relief.
struct HairMaterial {
  enum class Color : uint8_t { kAbsorption, kReflectance, kMelanin };

  Color color = Color::kAbsorption;
  SpectrumInput spectrum;             // the absorption or reflectance
  FloatInput eumelanin, pheomelanin;  // concentrations, of Color::kMelanin
  FloatInput eta, beta_m, beta_n, alpha;
  std::optional<HairFibre> fibre;  // if these four are constant

  static HairMaterial Read(MaterialReader& reader);
  bool ReadsTextures() const {
    return AnyTexture(spectrum, eumelanin, pheomelanin, eta, beta_m, beta_n, alpha);
  }
  bool IsIsotropic() const { return false; }
  Bxdf MakeBxdf(const MaterialContext& at) const;

 private:
  void ReadColor(MaterialReader& reader);
  SampledSpectrum Absorption(const MaterialContext& at) const;
};

}  // namespace tessera
