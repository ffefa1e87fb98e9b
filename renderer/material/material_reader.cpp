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

RoughnessInput MaterialReader::Roughness() {
  RoughnessInput roughness;
  const auto u = textures.FindFloat(parameters, "uroughness");
  const auto v = textures.FindFloat(parameters, "vroughness");
  roughness.u = u ? *u : Float("roughness", 0);
  roughness.v = v ? *v : u ? Float("roughness", 0) : roughness.u;
  roughness.remap = parameters.Bool("remaproughness", true);
  roughness.Prepare();
  return roughness;
}

EtaInput MaterialReader::Eta() {
  if (const std::optional<float> eta = parameters.FindFloat("eta")) {
    if (!(*eta >= 0 && *eta <= kEtaMax)) {
      parameters.FailAt("eta", fmt::format("\"eta\" must be from 0 to {}", kEtaMax));
      return {};
    }
    return EtaInput::From(Spectrum::Constant(*eta));
  }
  return EtaInput::From(SpectrumParameter(parameters, "eta", SpectrumUse::kUnbounded,
                                          Spectrum::Constant(1.5f), textures.files()));
}

}  // namespace tessera
