// What defines an RGB colour space, and the matrices that follow from it.
#pragma once

#include <array>
#include <string_view>

#include "renderer/color/spectrum.h"

namespace tessera {

using Matrix3d = std::array<std::array<double, 3>, 3>;  // rows

struct Chromaticity {
  double x = 0, y = 0;
};

struct RgbPrimaries {
  std::string_view name;
  Chromaticity red, green, blue;
  std::string_view white;  // name of the white point's spectrum
};

// ITU-R BT.709, P3-D65, ITU-R BT.2020 and SMPTE ST 2065-1.
inline constexpr RgbPrimaries kSrgbPrimaries = {
    "srgb", {0.64, 0.33}, {0.3, 0.6}, {0.15, 0.06}, "stdillum-D65"};
inline constexpr RgbPrimaries kDciP3Primaries = {
    "dci-p3", {0.68, 0.32}, {0.265, 0.69}, {0.15, 0.06}, "stdillum-D65"};
inline constexpr RgbPrimaries kRec2020Primaries = {
    "rec2020", {0.708, 0.292}, {0.17, 0.797}, {0.131, 0.046}, "stdillum-D65"};
inline constexpr RgbPrimaries kAcesPrimaries = {
    "aces2065-1", {0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.077}, "illum-acesD60"};

// XYZ of a spectrum, divided by kCieYIntegral. Exact sums in whole-nm steps.
std::array<double, 3> XyzOf(const DenseTable& spectrum);
// The inverse of a matrix that is known to have one.
Matrix3d Inverse(const Matrix3d& m);
// Maps RGB (1, 1, 1) to the XYZ of the white point's spectrum.
Matrix3d XyzFromRgb(const RgbPrimaries& primaries);

}  // namespace tessera
