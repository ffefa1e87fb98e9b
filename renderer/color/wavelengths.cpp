#include "renderer/color/wavelengths.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

// The density is kPeak / cosh^2((lambda - kCenter) / kWidth); Pharr, Jakob, Humphreys 2023, equation 4.22.
constexpr float kCenter = 538;         // nm
constexpr float kWidth = 138.888889f;  // nm
constexpr float kPeak = 0.0039398042f;
// u in [0, 1) runs over tanh values from kTanhFirst down by kTanhRange, that is from kLambdaMin to
// kLambdaMax.
constexpr float kTanhFirst = 0.85691062f;
constexpr float kTanhRange = 1.82750197f;

__m128i TableIndex(Float4 lambda) {
  const __m128i nearest = _mm_cvtps_epi32(_mm_add_ps(lambda.v, _mm_set1_ps(-kLambdaMin)));
  return _mm_min_epi32(_mm_max_epi32(nearest, _mm_setzero_si128()), _mm_set1_epi32(kLambdaCount - 1));
}

}  // namespace

SampledWavelengths SampledWavelengths::SampleVisible(float u) {
  alignas(16) float lambda[4], pdf[4];
  for (int i = 0; i < 4; ++i) {
    float rotated = u + 0.25f * static_cast<float>(i);
    if (rotated >= 1) rotated -= 1;
    const float tanh = kTanhFirst - kTanhRange * rotated;
    // atanh; and 1 / cosh^2 = 1 - tanh^2.
    lambda[i] = kCenter - (0.5f * kWidth) * std::log((1 + tanh) / (1 - tanh));
    pdf[i] = kPeak * (1 - tanh * tanh);
  }
  SampledWavelengths wavelengths;
  wavelengths.lambda = Float4(_mm_load_ps(lambda));
  wavelengths.pdf = Float4(_mm_load_ps(pdf));
  wavelengths.index = TableIndex(wavelengths.lambda);
  return wavelengths;
}

float SampledWavelengths::VisiblePdf(float lambda) {
  if (!(lambda >= kLambdaMin && lambda <= kLambdaMax)) return 0;
  const float decay = std::exp(-2 / kWidth * std::abs(lambda - kCenter));
  return kPeak * 4 * decay / ((1 + decay) * (1 + decay));
}

void SampledWavelengths::TerminateSecondary() {
  if (SecondaryTerminated()) return;
  pdf = Float4(pdf[0] * 0.25f, 0, 0, 0);
}

}  // namespace tessera
