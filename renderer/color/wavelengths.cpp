#include "renderer/color/wavelengths.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>

namespace tessera {
namespace {

// The density in arbitrary units at kLambdaMin, kLambdaMin + kKnotStep, ..., linear in between. Found by
// numerical optimisation: four wavelengths a quarter turn apart then give the sRGB values of white, of some
// saturated colours and of twenty random smooth reflectances with the least variance. What the eye is not
// sensitive to keeps a small share.
constexpr int kKnotStep = 10;  // nm
constexpr double kKnots[] = {0.22, 0.15, 0.12, 0.12, 0.23, 0.65, 1.31, 1.75, 2.17, 2.29, 2.10, 1.78,
                             1.64, 1.54, 1.75, 1.85, 2.12, 2.16, 2.06, 1.90, 1.98, 2.08, 1.95, 1.77,
                             1.72, 1.84, 1.92, 1.59, 1.24, 1.04, 0.90, 0.56, 0.39, 0.20, 0.10, 0.08,
                             0.07, 0.08, 0.07, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05, 0.06, 0.07, 0.09};
static_assert(kLambdaMin + kKnotStep * (std::size(kKnots) - 1) == kLambdaMax);

constexpr int kCells = 1024;  // divisible by 4

// The visible range cut into cells of equal probability, over each of which the density is constant.
struct VisibleCells {
  std::array<float, kCells + 1> edges{};  // nm
  std::array<float, kCells> pdf{};        // per nm

  constexpr VisibleCells() {
    // The cumulated density at whole nm, by trapezoids.
    std::array<double, kLambdaCount> cumulated{};
    for (int i = 1; i < kLambdaCount; ++i)
      cumulated[i] = cumulated[i - 1] + (DensityAt(i - 1) + DensityAt(i)) / 2;
    std::array<double, kCells + 1> exact{};
    int place = 0;
    for (int cell = 0; cell <= kCells; ++cell) {
      const double wanted = cumulated[kLambdaCount - 1] * cell / kCells;
      while (place < kLambdaCount - 2 && cumulated[place + 1] < wanted) ++place;
      exact[cell] =
          kLambdaMin + place + (wanted - cumulated[place]) / (cumulated[place + 1] - cumulated[place]);
      edges[cell] = static_cast<float>(exact[cell]);
    }
    for (int cell = 0; cell < kCells; ++cell)
      pdf[cell] = static_cast<float>(1 / (kCells * (exact[cell + 1] - exact[cell])));
  }

 private:
  static constexpr double DensityAt(int offset_nm) {
    const int knot = std::min(offset_nm / kKnotStep, static_cast<int>(std::size(kKnots)) - 2);
    const double t = static_cast<double>(offset_nm - knot * kKnotStep) / kKnotStep;
    return kKnots[knot] * (1 - t) + kKnots[knot + 1] * t;
  }
};
constexpr VisibleCells kVisible;

__m128i TableIndex(Float4 lambda) {
  const __m128i nearest = _mm_cvtps_epi32(_mm_add_ps(lambda.v, _mm_set1_ps(-kLambdaMin)));
  return _mm_min_epi32(_mm_max_epi32(nearest, _mm_setzero_si128()), _mm_set1_epi32(kLambdaCount - 1));
}

}  // namespace

SampledWavelengths SampledWavelengths::SampleVisible(float u) {
  const float place = u * kCells;
  const int first = std::min(static_cast<int>(place), kCells - 1);
  const float t = place - static_cast<float>(first);
  alignas(16) float lambda[4], pdf[4];
  for (int i = 0; i < 4; ++i) {
    const int cell = (first + i * (kCells / 4)) % kCells;
    lambda[i] = kVisible.edges[cell] + t * (kVisible.edges[cell + 1] - kVisible.edges[cell]);
    pdf[i] = kVisible.pdf[cell];
  }
  SampledWavelengths wavelengths;
  wavelengths.lambda = Float4(_mm_load_ps(lambda));
  wavelengths.pdf = Float4(_mm_load_ps(pdf));
  wavelengths.index = TableIndex(wavelengths.lambda);
  return wavelengths;
}

float SampledWavelengths::VisiblePdf(float lambda) {
  if (!(lambda >= kLambdaMin && lambda <= kLambdaMax)) return 0;
  const auto above = std::upper_bound(kVisible.edges.begin() + 1, kVisible.edges.end() - 1, lambda);
  return kVisible.pdf[static_cast<size_t>(above - kVisible.edges.begin() - 1)];
}

void SampledWavelengths::TerminateSecondary() {
  if (SecondaryTerminated()) return;
  pdf = Float4(pdf[0] * 0.25f, 0, 0, 0);
}

}  // namespace tessera
