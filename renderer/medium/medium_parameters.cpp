#include "renderer/medium/medium_parameters.h"

#include <algorithm>
#include <string>

#include "renderer/color/spectrum_parameter.h"

namespace tessera {

DenseTable Tabulate(const Spectrum& spectrum) {
  DenseTable table;
  for (int i = 0; i < kLambdaCount; ++i) table[i] = spectrum.At(static_cast<float>(kLambdaMin + i));
  return table;
}

void CheckCoefficients(const DenseTable& table, float factor, std::string_view name,
                       ParameterReader& reader) {
  const bool fine =
      std::ranges::all_of(table, [factor](float value) { return value * factor <= kCoefficientMax; });
  if (!fine) reader.FailAt(name, std::string(name) + " is too large: at most 1e20 per scene unit");
}

float LargestSum(const DenseTable& sigma_a, const DenseTable& sigma_s) {
  float largest = 0;
  for (size_t i = 0; i < sigma_a.size(); ++i) largest = std::max(largest, sigma_a[i] + sigma_s[i]);
  return largest;
}

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

Spectrum ReadCoefficient(ParameterReader& reader, std::string_view name, FileSource& files) {
  return SpectrumParameter(reader, name, SpectrumUse::kUnbounded, Spectrum::Constant(1), files);
}

Spectrum ReadRadiance(ParameterReader& reader, FileSource& files, float factor) {
  const Spectrum dark = Spectrum::Constant(0);
  const Spectrum radiance = SpectrumParameter(reader, "Le", SpectrumUse::kIlluminant, dark, files);
  const float luminance = SpectrumToPhotometric(radiance.WithoutColor());
  return luminance > 0 ? radiance.Scaled(factor / luminance) : dark;
}

}  // namespace tessera
