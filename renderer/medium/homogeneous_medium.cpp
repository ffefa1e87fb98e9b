#include "renderer/medium/homogeneous_medium.h"

#include "renderer/color/color_space.h"
#include "renderer/medium/medium_parameters.h"
#include "renderer/medium/scattering_presets.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

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

SampledSpectrum AllTheFirst(SampledSpectrum value) {
  return _mm_shuffle_ps(value.v, value.v, 0);
}

}  // namespace

HomogeneousMedium HomogeneousMedium::Read(ParameterReader& reader, const Transform& /*render_from_medium*/,
                                          FileSource& files, Diagnostics& diagnostics) {
  Spectrum sigma_a = Spectrum::Constant(1), sigma_s = sigma_a;
  if (const ScatteringPreset* preset = ReadPreset(reader, diagnostics)) {
    sigma_a = ColorSpace::Srgb().ToSpectrum(preset->sigma_a, SpectrumUse::kUnbounded);
    sigma_s = ColorSpace::Srgb().ToSpectrum(preset->sigma_s, SpectrumUse::kUnbounded);
  } else {
    sigma_a = ReadCoefficient(reader, "sigma_a", files);
    sigma_s = ReadCoefficient(reader, "sigma_s", files);
  }
  const float scale = ReadFactor(reader, "scale");
  const Spectrum radiance = ReadRadiance(reader, files, ReadFactor(reader, "Lescale"));
  HomogeneousMedium medium;
  medium.sigma_a_ = Tabulate(sigma_a.Scaled(scale));
  medium.sigma_s_ = Tabulate(sigma_s.Scaled(scale));
  CheckCoefficients(medium.sigma_a_, 1, "sigma_a", reader);
  CheckCoefficients(medium.sigma_s_, 1, "sigma_s", reader);
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
