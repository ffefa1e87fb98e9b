#include "renderer/denoise/firefly.h"

#include <algorithm>
#include <vector>

namespace tessera {
namespace {

constexpr size_t kSide = 2 * kFireflyRadius + 1;
constexpr size_t kAround = 2 * (kSide * kSide - 1);  // values, of both halves

// Plausible is what is not above the third quartile by more than this many times its distance to the median,
// nor above the third largest value, nor above kOtherHalf times the same pixel of the other half.
constexpr float kSpread = 3;
constexpr float kOtherHalf = 1.5f;
constexpr size_t kMedian = kAround / 2, kQuartile = kAround * 3 / 4, kThirdLargest = kAround - 3;
constexpr float kDark = 1e-4f;  // added, so that black surroundings do not make everything implausible

using Luminances = std::array<std::vector<float>, 2>;  // of the halves

// Of the pixels of a row and kFireflyRadius pixels beyond both ends.
Luminances LuminancesOf(const Strip& strip, int width, int y) {
  Luminances luminances;
  for (size_t half = 0; half < 2; ++half) {
    const auto& planes = strip.halves[half];
    const float* const r = planes[0].At(-kFireflyRadius, y);
    const float* const g = planes[1].At(-kFireflyRadius, y);
    const float* const b = planes[2].At(-kFireflyRadius, y);
    const int count = width + 2 * kFireflyRadius;
    luminances[half].resize(static_cast<size_t>(count));
    for (size_t i = 0; i < luminances[half].size(); ++i)
      luminances[half][i] = std::max(0.0f, 0.2126f * r[i] + 0.7152f * g[i] + 0.0722f * b[i]);
  }
  return luminances;
}

// The largest plausible luminance among the values around a pixel, which are reordered.
float PlausibleMax(std::array<float, kAround>& around) {
  const auto begin = around.begin();
  std::nth_element(begin, begin + kQuartile, around.end());
  const float quartile = around[kQuartile];
  std::nth_element(begin, begin + kMedian, begin + kQuartile);
  const float median = around[kMedian];
  std::nth_element(begin + kQuartile, begin + kThirdLargest, around.end());
  return std::max(quartile + kSpread * (quartile - median), around[kThirdLargest]) + kDark;
}

}  // namespace

void FindFireflies(const Strip& strip, int width, int y, std::array<Plane, 2>& factors) {
  std::array<Luminances, kSide> rows;
  for (size_t j = 0; j < kSide; ++j)
    rows[j] = LuminancesOf(strip, width, y + static_cast<int>(j) - kFireflyRadius);
  float* const to[2] = {factors[0].At(0, y), factors[1].At(0, y)};
  for (int x = 0; x < width; ++x) {
    std::array<float, kAround> around;
    size_t count = 0;
    for (size_t j = 0; j < kSide; ++j) {
      for (size_t i = 0; i < kSide; ++i) {
        if (j == kFireflyRadius && i == kFireflyRadius) continue;
        for (size_t half = 0; half < 2; ++half) around[count++] = rows[j][half][static_cast<size_t>(x) + i];
      }
    }
    const size_t center = static_cast<size_t>(x) + kFireflyRadius;
    const float own[2] = {rows[kFireflyRadius][0][center], rows[kFireflyRadius][1][center]};
    to[0][x] = to[1][x] = 1;
    const float brighter = std::max(own[0], own[1]);
    // Most pixels are plausible for the simplest reason.
    if (std::ranges::count_if(around, [&](float value) { return value >= brighter; }) >= 3) continue;
    const float plausible = PlausibleMax(around);
    for (size_t half = 0; half < 2; ++half) {
      const float limit = std::max(plausible, kOtherHalf * own[1 - half]);
      if (own[half] > limit) to[half][x] = limit / own[half];
    }
  }
}

}  // namespace tessera
