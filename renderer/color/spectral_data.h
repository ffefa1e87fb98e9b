// Published tables as they were published; named_spectra.h makes them into spectra. Pure data, in *_data.cpp.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "renderer/color/spectrum.h"

namespace tessera {

extern const DenseTable kCieXBar, kCieYBar, kCieZBar;

// The mean and the two first eigenvectors of daylight (Judd et al. 1964; CIE 15), from kLambdaMin every 5 nm.
constexpr int kDaylightStep = 5;  // nm
constexpr int kDaylightCount = (kLambdaMax - kLambdaMin) / kDaylightStep + 1;
extern const std::array<float, kDaylightCount> kDaylightS0, kDaylightS1, kDaylightS2;

// Values at `wavelengths` (nm, strictly rising), or at first, first + step, ... nm if there are none.
struct SpectralSeries {
  std::string_view name;
  std::span<const float> values;
  std::span<const float> wavelengths = {};
  float first = 0, step = 0;
};

std::span<const SpectralSeries> IlluminantSeries();
std::span<const SpectralSeries> MetalSeries();
std::span<const SpectralSeries> GlassSeries();
// Of cameras: "NAME_r", "NAME_g" and "NAME_b", one after the other.
std::span<const SpectralSeries> SensorSeries();
// Of the patches of a ColorChecker chart.
std::span<const SpectralSeries> ColorCheckerSeries();

}  // namespace tessera
