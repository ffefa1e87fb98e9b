// Finds the sigmoid polynomial whose colour under a white light is a given RGB triple (Jakob and Hanika 2019,
// "A Low-Dimensional Function Space for Efficient Spectral Upsampling"). Only + - * / and sqrt of doubles are
// used, so the bits of the answer are the same on all machines.
#pragma once

#include <array>

#include "renderer/color/rgb_primaries.h"
#include "renderer/color/spectrum.h"

namespace tessera {

// Of the polynomial in t = (lambda - kLambdaMin) / (kLambdaMax - kLambdaMin), highest power first.
using SigmoidCoefficients = std::array<double, 3>;

// Immutable; safe to share between threads.
class SigmoidSolver {
 public:
  explicit SigmoidSolver(const RgbPrimaries& primaries);

  // The coefficients that come closest, in CIE L*a*b*, to `rgb` with components in [0, 1]. `start` is a
  // guess; that of a similar colour saves time. Always finite.
  SigmoidCoefficients Solve(const std::array<double, 3>& rgb, SigmoidCoefficients start) const;

  // The polynomial in nm.
  static SigmoidPolynomial ToPolynomial(const SigmoidCoefficients& coefficients);
  // The constant `value` in [0, 1].
  static SigmoidPolynomial Grey(float value);

 private:
  static constexpr size_t kLanes = 4;
  static constexpr size_t kPaddedCount = (kLambdaCount + kLanes - 1) / kLanes * kLanes;

  struct Response;  // a colour and its derivatives
  Response Evaluate(const SigmoidCoefficients& coefficients) const;

  alignas(32) std::array<double, kPaddedCount> t_{};
  // Matching function times white, so that a spectrum of 1 gives (1, 1, 1); 0 in the padding.
  alignas(32) std::array<std::array<double, kPaddedCount>, 3> weight_{};
  Matrix3d relative_xyz_from_rgb_{};  // XYZ divided by that of the white
};

}  // namespace tessera
