// The four wavelengths that one path carries ("hero wavelength" sampling, Wilkie et al. 2014).
#pragma once

#include <immintrin.h>

#include "renderer/color/sampled_spectrum.h"

namespace tessera {

constexpr int kLambdaMin = 360;  // nm: the visible range that is sampled and tabulated
constexpr int kLambdaMax = 830;  // nm, inclusive
constexpr int kLambdaCount = kLambdaMax - kLambdaMin + 1;

// Four wavelengths with their densities. Chosen once per camera path, then read only, but for
// TerminateSecondary.
struct SampledWavelengths {
  Float4 lambda;  // nm
  Float4 pdf;     // per nm; 0 for a terminated wavelength
  __m128i index;  // lambda rounded to the nearest whole nm, minus kLambdaMin: a place in a dense table

  // With a density that follows what the eye is sensitive to, so that the four together see nearly the colour
  // that all wavelengths would: colour noise is what they miss. The four are u, u + 1/4, u + 1/2, u + 3/4,
  // wrapped. u in [0, 1).
  static SampledWavelengths SampleVisible(float u);
  // The density per nm of SampleVisible at a wavelength; 0 outside [kLambdaMin, kLambdaMax].
  static float VisiblePdf(float lambda);

  // Drops all wavelengths but the first, whose density takes over the weight of the four: for interfaces that
  // bend each wavelength differently. Does nothing the second time.
  void TerminateSecondary();
  bool SecondaryTerminated() const { return pdf[1] == 0 && pdf[2] == 0 && pdf[3] == 0; }
  // The wavelengths at which the path goes on: four times the first once the others are dropped.
  SampledWavelengths Followed() const {
    if (!SecondaryTerminated()) return *this;
    return {_mm_shuffle_ps(lambda.v, lambda.v, 0), pdf, _mm_shuffle_epi32(index, 0)};
  }
};

}  // namespace tessera
