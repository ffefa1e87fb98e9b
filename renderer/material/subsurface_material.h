// Skin, marble, milk: light enters, is scattered below the surface and leaves nearby.
#pragma once

#include <memory>

#include "renderer/bssrdf/bssrdf.h"
#include "renderer/bxdf/bxdf.h"
#include "renderer/material/material_reader.h"

namespace tessera {

// Where a path that has entered such a surface comes out.
struct Subsurface {
  Bssrdf bssrdf;
  NormalizedFresnelBxdf exit;  // scatters at the point where it comes out
};

// Parameters, of which the first of these counts: string name of measured coefficients, per mm; spectrum
// textures sigma_a and sigma_s; spectrum textures reflectance and mfp (1); else those of ketchup-like default
// coefficients. float scale (1) of the coefficients or of mfp, float eta (1.33), float g (0) of the phase
// function (0 with a name), and the roughness parameters of MaterialReader.
//
// The profile is tabulated and radial, as in pbrt-v4: only so do pictures agree, and surfaces need not be
// closed.
struct SubsurfaceMaterial {
  enum class Colors : uint8_t { kCoefficients, kReflectance };

  Colors colors = Colors::kCoefficients;
  SpectrumInput sigma_a, sigma_s;  // of kCoefficients
  SpectrumInput reflectance, mfp;  // of kReflectance
  float scale = 1;
  float eta = 1.33f;
  float transmittance = 1;  // of diffuse light through the interface
  RoughnessInput roughness;
  std::shared_ptr<const DiffusionProfile> profile;  // shared by materials with the same g and eta

  static SubsurfaceMaterial Read(MaterialReader& reader);
  bool ReadsTextures() const { return AnyTexture(sigma_a, sigma_s, reflectance, mfp, roughness); }
  bool IsIsotropic() const { return roughness.IsIsotropic(); }
  Bxdf MakeBxdf(const MaterialContext& at) const { return DielectricBxdf(at(roughness), eta); }
  // ns: the shading normal at p.
  Subsurface At(const MaterialContext& at, Point3 p, Normal3 ns) const;

 private:
  void ReadColors(MaterialReader& reader, float* g);
};

}  // namespace tessera
