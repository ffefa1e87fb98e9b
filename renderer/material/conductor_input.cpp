#include "renderer/material/conductor_input.h"

#include <fmt/format.h>

#include "renderer/color/named_spectra.h"

namespace tessera {
namespace {

SpectrumInput NamedMetal(std::string_view name) {
  return {Spectrum::Table(NamedSpectrum(name)), -1};
}

}  // namespace

ConductorInput ConductorInput::Read(MaterialReader& reader, const std::string& prefix) {
  ConductorInput metal;
  ParameterReader& parameters = reader.parameters;
  const auto eta = reader.textures.FindSpectrum(parameters, prefix + "eta", SpectrumUse::kUnbounded);
  const auto k = reader.textures.FindSpectrum(parameters, prefix + "k", SpectrumUse::kUnbounded);
  const auto reflectance = reader.textures.FindSpectrum(parameters, "reflectance", SpectrumUse::kAlbedo);
  if (reflectance && (eta || k)) {
    parameters.FailAt(
        "reflectance",
        fmt::format("a conductor has either \"reflectance\" or \"{0}eta\" and \"{0}k\", not both", prefix));
  }
  if (reflectance) {
    metal.has_reflectance = true;
    metal.eta = *reflectance;
  } else {
    metal.eta = eta ? *eta : NamedMetal("metal-Cu-eta");
    metal.k = k ? *k : NamedMetal("metal-Cu-k");
  }
  return metal;
}

ConductorIndex ConductorInput::Evaluate(const MaterialContext& at) const {
  if (!has_reflectance) return {at(eta), at(k)};
  // The k that reflects this much at normal incidence where eta is 1.
  const SampledSpectrum r = Clamp(at(eta), 0, 0.9999f);
  return {SampledSpectrum(1.0f), 2.0f * Sqrt(r) / SafeSqrt(1.0f - r)};
}

}  // namespace tessera
