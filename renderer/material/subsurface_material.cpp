#include "renderer/material/subsurface_material.h"

#include <fmt/format.h>

#include "renderer/color/color_space.h"
#include "renderer/medium/scattering_presets.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

// Lengths and coefficients that keep their products finite.
constexpr float kCoefficientMax = 1e15f, kMeanFreePathMin = 1e-15f, kMeanFreePathMax = 1e15f;
// Beyond these the integrals of the profile lose their meaning.
constexpr float kAsymmetryMax = 0.99f, kEtaMin = 0.1f, kEtaMax = 10;

SpectrumInput Coefficient(Vec3 rgb) {
  return {ColorSpace::Srgb().ToSpectrum(rgb, SpectrumUse::kUnbounded), -1};
}

const ScatteringPreset* ReadNamed(ParameterReader& parameters) {
  const std::string name = parameters.String("name", "");
  if (name.empty()) return nullptr;
  const ScatteringPreset* preset = FindScatteringPreset(name);
  if (preset != nullptr) return preset;
  std::vector<std::string_view> known;
  for (const ScatteringPreset& candidate : ScatteringPresets()) known.push_back(candidate.name);
  parameters.FailAt("name",
                    fmt::format("unknown scattering medium {}{}", Quoted(name), DidYouMean(name, known)));
  return nullptr;
}

float ReadWithin(ParameterReader& parameters, std::string_view name, float default_value, float low,
                 float high) {
  const float value = parameters.Float(name, default_value);
  if (value >= low && value <= high) return value;
  parameters.FailAt(name, fmt::format("\"{}\" must be from {} to {}", name, low, high));
  return default_value;
}

}  // namespace

void SubsurfaceMaterial::ReadColors(MaterialReader& reader, float* g) {
  ParameterReader& parameters = reader.parameters;
  constexpr SpectrumUse kUnbounded = SpectrumUse::kUnbounded;
  const ScatteringPreset* preset = ReadNamed(parameters);
  const auto absorption = reader.textures.FindSpectrum(parameters, "sigma_a", kUnbounded);
  const auto scattering = reader.textures.FindSpectrum(parameters, "sigma_s", kUnbounded);
  const auto albedo = reader.textures.FindSpectrum(parameters, "reflectance", SpectrumUse::kAlbedo);
  mfp = reader.textures.SpectrumOf(parameters, "mfp", kUnbounded, Spectrum::Constant(1));
  if (absorption.has_value() != scattering.has_value())
    parameters.FailAt(absorption ? "sigma_a" : "sigma_s", "\"sigma_a\" and \"sigma_s\" belong together");
  // As in pbrt without any of them: per mm.
  sigma_a = Coefficient({0.0011f, 0.0024f, 0.014f});
  sigma_s = Coefficient({2.55f, 3.21f, 3.77f});
  if (preset != nullptr) {
    sigma_a = Coefficient(preset->sigma_a);
    sigma_s = Coefficient(preset->sigma_s);
    *g = 0;
  } else if (absorption && scattering) {
    sigma_a = *absorption;
    sigma_s = *scattering;
  } else if (albedo) {
    colors = Colors::kReflectance;
    reflectance = *albedo;
  }
}

SubsurfaceMaterial SubsurfaceMaterial::Read(MaterialReader& reader) {
  SubsurfaceMaterial material;
  ParameterReader& parameters = reader.parameters;
  float g = ReadWithin(parameters, "g", 0, -1, 1);
  material.ReadColors(reader, &g);
  material.scale = parameters.Float("scale", 1);
  if (material.scale < 0) parameters.FailAt("scale", "\"scale\" must not be negative");
  material.eta = ReadWithin(parameters, "eta", 1.33f, kEtaMin, kEtaMax);
  material.roughness = reader.Roughness();
  if (parameters.failed()) return material;
  material.transmittance = NormalizedFresnelBxdf::HemisphericalTransmittance(material.eta);
  material.profile = reader.profiles.Get(std::clamp(g, -kAsymmetryMax, kAsymmetryMax), material.eta);
  return material;
}

Subsurface SubsurfaceMaterial::At(const MaterialContext& at, Point3 p, Normal3 ns) const {
  SampledSpectrum a, s;
  if (colors == Colors::kCoefficients) {
    a = Clamp(at(sigma_a) * scale, 0, kCoefficientMax);
    s = Clamp(at(sigma_s) * scale, 0, kCoefficientMax);
  } else {
    const SampledSpectrum effective = Clamp(at(reflectance), 0, 1);
    const SampledSpectrum length = Clamp(at(mfp) * scale, kMeanFreePathMin, kMeanFreePathMax);
    for (int i = 0; i < 4; ++i) {
      const float albedo = profile->AlbedoOf(effective[i]);
      s.Set(i, albedo / length[i]);
      a.Set(i, (1 - albedo) / length[i]);
    }
  }
  return {Bssrdf(*profile, p, ns, a, s), NormalizedFresnelBxdf(eta, transmittance)};
}

}  // namespace tessera
