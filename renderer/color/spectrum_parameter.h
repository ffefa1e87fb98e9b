// From a parameter of the scene language to a Spectrum.
#pragma once

#include "renderer/color/color_space.h"
#include "renderer/color/spectrum.h"
#include "renderer/description/file_source.h"
#include "renderer/description/parameter_reader.h"

namespace tessera {

// Checks ranges (an albedo in [0, 1], no negative component) and reads spectrum files from `files`. Errors
// have the parameter's place.
Result<Spectrum> MakeSpectrum(const SpectrumValue& value, SpectrumUse use, FileSource& files);

// The rgb, spectrum or blackbody parameter `name`, or `default_value`; errors are remembered by the reader.
Spectrum SpectrumParameter(ParameterReader& reader, std::string_view name, SpectrumUse use,
                           const Spectrum& default_value, FileSource& files);
std::optional<Spectrum> FindSpectrumParameter(ParameterReader& reader, std::string_view name, SpectrumUse use,
                                              FileSource& files);

}  // namespace tessera
