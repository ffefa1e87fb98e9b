#include "renderer/medium/homogeneous_medium.h"

#include <algorithm>

#include "renderer/color/color_space.h"
#include "renderer/color/spectrum_parameter.h"
#include "renderer/medium/scattering_presets.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr float kCoefficientMax = 1e20f;  // per scene unit: products of two are finite

DenseTable Tabulate(const Spectrum& spectrum) {
  DenseTable table;
  for (int i = 0; i < kLambdaCount; ++i) table[i] = spectrum.At(static_cast<float>(kLambdaMin + i));
  return table;
}

void CheckCoefficients(const DenseTable& table, const char* name, ParameterReader& reader) {
  const bool fine = std::ranges::all_of(table, [](float value) { return value <= kCoefficientMax; });
  if (!fine) reader.FailAt(name, std::string(name) + " is too large: at most 1e20 per scene unit");
}

// A factor of the medium's coefficients or emission.
float ReadFactor(ParameterReader& reader, std::string_view name) {
  const float factor = reader.Float(name, 1);
  if (factor < 0) reader.FailAt(name, std::string(name) + " must not be negative");
  return std::max(factor, 0.0f);
}

float ReadAsymmetry(ParameterReader& reader) {
  const float g = reader.Float("g", 0);
  if (!(g >= -1 && g <= 1)) reader.FailAt("g", "g must lie between -1 and 1");
  return g;
}

const ScatteringPreset* ReadPreset(ParameterReader& reader, Diagnostics& diagnostics) {
  const std::optional<std::string> name = reader.FindString("preset");
  if (!name || name->empty()) return nullptr;
  const ScatteringPreset* preset = FindScatteringPreset(*name);
  if (preset == nullptr) {
    std::vector<std::string_view> known;
    for (const ScatteringPreset& candidate : ScatteringPresets()) known.push_back(candidate.name);
    diagnostics.Warn(reader.LocationOf("preset"), "unknown medium preset \"" + *name + "\"" +
                                                      DidYouMean(*name, known) +
                                                      ": sigma_a and sigma_s apply instead");
  }
  return preset;
}

// Emitted radiance, with luminance 1 times the factor where it is given as a spectrum; the colour of an RGB
// triple keeps its magnitude.
Spectrum ReadRadiance(ParameterReader& reader, FileSource& files) {
  const Spectrum dark = Spectrum::Constant(0);
  const Spectrum radiance = SpectrumParameter(reader, "Le", SpectrumUse::kIlluminant, dark, files);
  const float factor = ReadFactor(reader, "Lescale");
  const float luminance = SpectrumToPhotometric(radiance.WithoutColor());
  return luminance > 0 ? radiance.Scaled(factor / luminance) : dark;
}

SampledSpectrum AllTheFirst(SampledSpectrum value) {
  return _mm_shuffle_ps(value.v, value.v, 0);
}

}  // namespace

HomogeneousMedium HomogeneousMedium::Read(ParameterReader& reader, FileSource& files,
                                          Diagnostics& diagnostics) {
  Spectrum sigma_a = Spectrum::Constant(1), sigma_s = sigma_a;
  if (const ScatteringPreset* preset = ReadPreset(reader, diagnostics)) {
    sigma_a = ColorSpace::Srgb().ToSpectrum(preset->sigma_a, SpectrumUse::kUnbounded);
    sigma_s = ColorSpace::Srgb().ToSpectrum(preset->sigma_s, SpectrumUse::kUnbounded);
  } else {
    sigma_a = SpectrumParameter(reader, "sigma_a", SpectrumUse::kUnbounded, sigma_a, files);
    sigma_s = SpectrumParameter(reader, "sigma_s", SpectrumUse::kUnbounded, sigma_s, files);
  }
  const float scale = ReadFactor(reader, "scale");
  const Spectrum radiance = ReadRadiance(reader, files);
  HomogeneousMedium medium;
  medium.sigma_a_ = Tabulate(sigma_a.Scaled(scale));
  medium.sigma_s_ = Tabulate(sigma_s.Scaled(scale));
  CheckCoefficients(medium.sigma_a_, "sigma_a", reader);
  CheckCoefficients(medium.sigma_s_, "sigma_s", reader);
  medium.emission_ = Tabulate(radiance);
  for (int i = 0; i < kLambdaCount; ++i) {
    medium.emission_[i] *= medium.sigma_a_[i];
    if (medium.emission_[i] > 0) medium.is_emissive_ = true;
  }
  medium.phase_ = PhaseFunction(ReadAsymmetry(reader));
  return medium;
}

HomogeneousCoefficients HomogeneousMedium::At(const SampledWavelengths& wavelengths) const {
  HomogeneousCoefficients at{SampleTable(sigma_a_, wavelengths), SampleTable(sigma_s_, wavelengths),
                             SampledSpectrum()};
  if (is_emissive_) at.emission = SampleTable(emission_, wavelengths);
  if (wavelengths.SecondaryTerminated()) {
    at = {AllTheFirst(at.sigma_a), AllTheFirst(at.sigma_s), AllTheFirst(at.emission)};
  }
  return at;
}

}  // namespace tessera
