// The exposures at which HDR-FLIP compares pictures, and the tone mapper that it applies (flip.h names the
// papers).
#pragma once

#include <vector>

#include "renderer/compare/flip.h"

namespace tessera {

// ACES in the fit of Narkowicz (2015), a rational polynomial, with the factor 0.6 that undoes the exposure
// of its lookup table.
struct AcesCurve {
  static constexpr double kNumerator[] = {0.6 * 0.6 * 2.51, 0.6 * 0.03, 0};
  static constexpr double kDenominator[] = {0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14};

  // From 0 to 1; `value` is not negative.
  static float Map(float value);
};

// From the exposure at which the brightest pixel of the reference is mapped to kKneeValue to the one at which
// the median pixel is, about one stop apart. Takes luminances; those that are not finite are left out.
ExposureRange ExposuresFor(std::vector<float> luminances);

}  // namespace tessera
