#include "renderer/color/spectrum_parameter.h"

namespace tessera {

std::optional<Spectrum> FindSpectrumParameter(ParameterReader& reader, std::string_view name, SpectrumUse use,
                                              FileSource& files) {
  const std::optional<SpectrumValue> value = reader.FindSpectrum(name);
  if (!value) return std::nullopt;
  Result<Spectrum> spectrum = MakeSpectrum(*value, use, files);
  if (spectrum) return std::move(spectrum).value();
  reader.Fail(spectrum.error());
  return std::nullopt;
}

Spectrum SpectrumParameter(ParameterReader& reader, std::string_view name, SpectrumUse use,
                           const Spectrum& default_value, FileSource& files) {
  return FindSpectrumParameter(reader, name, use, files).value_or(default_value);
}

}  // namespace tessera
