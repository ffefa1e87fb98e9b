// The spectra of lights: how they are normalised, and their strength.
#pragma once

#include <string_view>

#include "renderer/color/color_space.h"
#include "renderer/color/spectrum.h"
#include "renderer/description/file_source.h"
#include "renderer/description/parameter_reader.h"

namespace tessera {

// The factor that gives `spectrum` luminance 1. It removes the magnitude of a `spectrum` or `blackbody`; an
// RGB triple keeps its own, as only its white is measured. 0 for a black spectrum.
float UnitLuminanceScale(const Spectrum& spectrum);

// The spectrum parameter `name`, or the white of the default colour space, with luminance 1 times parameter
// `scale`.
Spectrum ReadEmission(ParameterReader& reader, std::string_view name, FileSource& files);
// Parameter `scale` for images, whose colours are multiplied by the white of their colour space.
float ReadImageScale(ParameterReader& reader, const ColorSpace& color_space);
// A parameter that sets a total (`power`, `illuminance`). Returns nullopt if it is absent or not positive.
std::optional<float> ReadTotal(ParameterReader& reader, std::string_view name);

// The magnitude of a spectrum for choosing between lights: its mean, weighted by the sum of the three
// matching functions, without its sign.
float Strength(const Spectrum& spectrum);

// Luminance of linear RGB relative to that of the white (1, 1, 1).
float RelativeLuminance(const ColorSpace& color_space, Rgb rgb);

}  // namespace tessera
