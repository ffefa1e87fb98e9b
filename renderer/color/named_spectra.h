// Tables of colour science: matching functions, illuminants, metals and glasses, by the names pbrt gives
// them.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "renderer/color/spectrum.h"
#include "renderer/util/result.h"

namespace tessera {

// The CIE 1931 2-degree colour matching functions.
const DenseTable& CieX();
const DenseTable& CieY();
const DenseTable& CieZ();
constexpr float kCieYIntegral = 106.856895f;  // of y-bar over the visible range, per nm

// A spectrum that pbrt knows by name ("metal-Cu-eta", "glass-BK7", "stdillum-D65", ...), linearly
// interpolated and, as pbrt does, constant beyond its samples; illuminants are scaled to a luminance integral
// of kCieYIntegral. nullptr for an unknown name. Lives for the whole program.
std::shared_ptr<const DenseTable> NamedSpectrum(std::string_view name);
// All names, for suggestions.
std::span<const std::string_view> NamedSpectrumNames();

// Cameras whose sensitivities are the named spectra NAME_r, NAME_g and NAME_b.
std::span<const std::string_view> SensorNames();
// The reflectances of the 24 patches of a ColorChecker chart.
std::span<const DenseTable> ColorCheckerPatches();

// Piecewise linear through (wavelength in nm, value) pairs with strictly rising wavelengths; 0 outside.
std::shared_ptr<const DenseTable> TableFromSamples(std::span<const float> wavelengths,
                                                   std::span<const float> values);
// Planck's law at `kelvin` and a wavelength in nm, scaled so that its maximum over all wavelengths is 1. 0
// unless kelvin > 0.
float BlackbodyValue(float kelvin, float lambda);
// The same for all wavelengths.
std::shared_ptr<const DenseTable> Blackbody(float kelvin);
// CIE D illuminant of a correlated colour temperature in kelvin, for white balance.
std::shared_ptr<const DenseTable> DaylightIlluminant(float kelvin);

}  // namespace tessera
