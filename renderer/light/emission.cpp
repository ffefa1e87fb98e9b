#include "renderer/light/emission.h"

#include "renderer/color/named_spectra.h"
#include "renderer/color/spectrum_parameter.h"

namespace tessera {

float UnitLuminanceScale(const Spectrum& spectrum) {
  const float luminance = SpectrumToPhotometric(spectrum.WithoutColor());
  return luminance > 0 ? 1 / luminance : 0;
}

Spectrum ReadEmission(ParameterReader& reader, std::string_view name, FileSource& files) {
  const Spectrum white = Spectrum::Table(ColorSpace::Srgb().illuminant());
  const Spectrum spectrum = SpectrumParameter(reader, name, SpectrumUse::kIlluminant, white, files);
  return spectrum.Scaled(reader.Float("scale", 1) * UnitLuminanceScale(spectrum));
}

float ReadImageScale(ParameterReader& reader, const ColorSpace& color_space) {
  return reader.Float("scale", 1) * UnitLuminanceScale(Spectrum::Table(color_space.illuminant()));
}

std::optional<float> ReadTotal(ParameterReader& reader, std::string_view name) {
  const float value = reader.Float(name, -1);
  if (value > 0) return value;
  return std::nullopt;
}

float Strength(const Spectrum& spectrum) {
  double sum = 0, weights = 0;
  for (int i = 0; i < kLambdaCount; ++i) {
    const double weight = static_cast<double>(CieX()[i]) + CieY()[i] + CieZ()[i];
    sum += weight * spectrum.At(static_cast<float>(kLambdaMin + i));
    weights += weight;
  }
  return static_cast<float>(std::abs(sum / weights));
}

float RelativeLuminance(const ColorSpace& color_space, Rgb rgb) {
  return color_space.ToXyz(rgb).y / color_space.ToXyz({1, 1, 1}).y;
}

}  // namespace tessera
