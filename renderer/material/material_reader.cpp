#include "renderer/material/material_reader.h"

#include <fmt/format.h>

#include "renderer/color/spectrum_parameter.h"

namespace tessera {

SpectrumInput MaterialReader::Albedo(std::string_view name, float default_value) {
  return textures.SpectrumOf(parameters, name, SpectrumUse::kAlbedo, Spectrum::Constant(default_value));
}

FloatInput MaterialReader::Float(std::string_view name, float default_value) {
  return textures.Float(parameters, name, default_value);
}

RoughnessInput MaterialReader::Roughness(const std::string& prefix) {
  RoughnessInput roughness;
  const std::string both = prefix + "roughness";
  const auto u = textures.FindFloat(parameters, prefix + "uroughness");
  const auto v = textures.FindFloat(parameters, prefix + "vroughness");
  roughness.u = u ? *u : Float(both, 0);
  roughness.v = v ? *v : u ? Float(both, 0) : roughness.u;
  roughness.remap = parameters.Bool("remaproughness", true);
  roughness.Prepare();
  return roughness;
}

EtaInput MaterialReader::Eta(std::string_view name) {
  if (const std::optional<float> eta = parameters.FindFloat(name)) {
    if (!(*eta >= 0 && *eta <= kEtaMax)) {
      parameters.FailAt(name, fmt::format("\"{}\" must be from 0 to {}", name, kEtaMax));
      return {};
    }
    return EtaInput::From(Spectrum::Constant(*eta));
  }
  return EtaInput::From(SpectrumParameter(parameters, name, SpectrumUse::kUnbounded, Spectrum::Constant(1.5f),
                                          textures.files()));
}

}  // namespace tessera
