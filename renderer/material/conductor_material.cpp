#include "renderer/material/conductor_material.h"

#include "renderer/color/named_spectra.h"

namespace tessera {
namespace {

SpectrumInput NamedMetal(std::string_view name) {
  return {Spectrum::Table(NamedSpectrum(name)), -1};
}

}  // namespace

ConductorMaterial ConductorMaterial::Read(MaterialReader& reader) {
  ConductorMaterial material;
  ParameterReader& parameters = reader.parameters;
  const auto eta = reader.textures.FindSpectrum(parameters, "eta", SpectrumUse::kUnbounded);
  const auto k = reader.textures.FindSpectrum(parameters, "k", SpectrumUse::kUnbounded);
  const auto reflectance = reader.textures.FindSpectrum(parameters, "reflectance", SpectrumUse::kAlbedo);
  if (reflectance && (eta || k)) {
    parameters.FailAt("reflectance", "a conductor has either \"reflectance\" or \"eta\" and \"k\", not both");
  }
  if (reflectance) {
    material.has_reflectance = true;
    material.eta = *reflectance;
  } else {
    material.eta = eta ? *eta : NamedMetal("metal-Cu-eta");
    material.k = k ? *k : NamedMetal("metal-Cu-k");
  }
  material.roughness = reader.Roughness();
  return material;
}

Bxdf ConductorMaterial::MakeBxdf(const MaterialContext& at) const {
  const MicrofacetDistribution facets = at(roughness);
  if (!has_reflectance) return ConductorBxdf(facets, at(eta), at(k));
  // The k that reflects this much at normal incidence where eta is 1.
  const SampledSpectrum r = Clamp(at(eta), 0, 0.9999f);
  return ConductorBxdf(facets, SampledSpectrum(1.0f), 2.0f * Sqrt(r) / SafeSqrt(1.0f - r));
}

}  // namespace tessera
