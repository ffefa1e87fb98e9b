#include "renderer/material/hair_material.h"

#include <fmt/format.h>

#include "renderer/color/color_space.h"

namespace tessera {
namespace {

constexpr float kConcentrationMax = 1e4f;  // black; keeps products finite

// Absorption of the two pigments of hair in sRGB (d'Eon et al. 2011).
Rgb MelaninAbsorption(float eumelanin, float pheomelanin) {
  const float e = std::min(kConcentrationMax, std::max(0.0f, eumelanin));
  const float p = std::min(kConcentrationMax, std::max(0.0f, pheomelanin));
  return {e * 0.419f + p * 0.187f, e * 0.697f + p * 0.4f, e * 1.37f + p * 1.05f};
}

}  // namespace

HairMaterial HairMaterial::Read(MaterialReader& reader) {
  HairMaterial material;
  material.ReadColor(reader);
  material.eta = reader.Float("eta", 1.55f);
  material.beta_m = reader.Float("beta_m", 0.3f);
  material.beta_n = reader.Float("beta_n", 0.3f);
  material.alpha = reader.Float("alpha", 2);
  if (!AnyTexture(material.eta, material.beta_m, material.beta_n, material.alpha)) {
    material.fibre.emplace(material.eta.constant, material.beta_m.constant, material.beta_n.constant,
                           material.alpha.constant);
  }
  return material;
}

void HairMaterial::ReadColor(MaterialReader& reader) {
  TextureBuilder& textures = reader.textures;
  ParameterReader& parameters = reader.parameters;
  const auto sigma_a = textures.FindSpectrum(parameters, "sigma_a", SpectrumUse::kUnbounded);
  auto reflectance = textures.FindSpectrum(parameters, "reflectance", SpectrumUse::kAlbedo);
  const auto alias = textures.FindSpectrum(parameters, "color", SpectrumUse::kAlbedo);
  if (!reflectance) reflectance = alias;
  const auto eumelanin_given = textures.FindFloat(parameters, "eumelanin");
  const auto pheomelanin_given = textures.FindFloat(parameters, "pheomelanin");
  const auto ignore = [&](const char* winner, std::initializer_list<const char*> names) {
    for (const char* name : names) {
      if (!parameters.Has(name)) continue;
      textures.diagnostics().Warn(
          parameters.LocationOf(name),
          fmt::format("\"{}\" of hair is ignored because there is \"{}\"", name, winner));
    }
  };
  if (sigma_a) {
    spectrum = *sigma_a;
    ignore("sigma_a", {"reflectance", "color", "eumelanin", "pheomelanin"});
    return;
  }
  if (reflectance) {
    color = Color::kReflectance;
    spectrum = *reflectance;
    ignore("reflectance", {"eumelanin", "pheomelanin"});
    return;
  }
  const bool any = eumelanin_given || pheomelanin_given;
  eumelanin = eumelanin_given.value_or(FloatInput{any ? 0 : 1.3f, -1});
  pheomelanin = pheomelanin_given.value_or(FloatInput{0, -1});
  if (AnyTexture(eumelanin, pheomelanin)) {
    color = Color::kMelanin;
  } else {
    const Rgb rgb = MelaninAbsorption(eumelanin.constant, pheomelanin.constant);
    spectrum = {ColorSpace::Srgb().ToSpectrum(rgb, SpectrumUse::kUnbounded), -1};
  }
}

SampledSpectrum HairMaterial::Absorption(const MaterialContext& at) const {
  switch (color) {
    case Color::kAbsorption: return Max(at(spectrum), SampledSpectrum(0.0f));
    case Color::kReflectance: return HairBxdf::AbsorptionOfReflectance(at(spectrum), at(beta_n));
    case Color::kMelanin: break;
  }
  const Rgb rgb = MelaninAbsorption(at(eumelanin), at(pheomelanin));
  return Max(ColorSpace::Srgb().SampleFast(rgb, SpectrumUse::kUnbounded, at.wavelengths),
             SampledSpectrum(0.0f));
}

Bxdf HairMaterial::MakeBxdf(const MaterialContext& at) const {
  const float h = 2 * at.texture_context.uv.y - 1;
  const SampledSpectrum sigma_a = Absorption(at);
  if (fibre) return HairBxdf(*fibre, h, sigma_a);
  return HairBxdf(HairFibre(at(eta), at(beta_m), at(beta_n), at(alpha)), h, sigma_a);
}

}  // namespace tessera
