#include "renderer/compare/exposures.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

constexpr double kKneeValue = 0.85;  // t_max and t_min of the paper
constexpr int kExposuresMin = 2;

// The value that the curve maps to `mapped`: the positive root of a quadratic equation.
double InverseAces(double mapped) {
  constexpr auto& n = AcesCurve::kNumerator;
  constexpr auto& d = AcesCurve::kDenominator;
  const double square = n[0] - d[0] * mapped;
  const double half_linear = 0.5 * (n[1] - d[1] * mapped) / square;
  const double constant = (n[2] - d[2] * mapped) / square;
  return -half_linear + std::sqrt(half_linear * half_linear - constant);
}

double Median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (double{*middle} + *std::max_element(values.begin(), middle));
}

}  // namespace

float AcesCurve::Map(float value) {
  constexpr float kWhite = 1e6f;  // mapped to 1, and small enough that its square is finite
  const float x = std::min(value, kWhite);
  const float numerator = static_cast<float>(kNumerator[0]) * x * x + static_cast<float>(kNumerator[1]) * x;
  const float denominator = static_cast<float>(kDenominator[0]) * x * x +
                            static_cast<float>(kDenominator[1]) * x + static_cast<float>(kDenominator[2]);
  return std::min(numerator / denominator, 1.0f);
}

ExposureRange ExposuresFor(std::vector<float> luminances) {
  std::erase_if(luminances, [](float value) { return !std::isfinite(value); });
  if (luminances.empty()) return {};
  const double brightest = *std::ranges::max_element(luminances);
  if (brightest <= 0) return {};
  const double median = std::max(Median(luminances), double{std::numeric_limits<float>::epsilon()});
  const double knee = InverseAces(kKneeValue);
  ExposureRange range;
  range.start = std::log2(knee / brightest);
  range.stop = std::max(range.start, std::log2(knee / median));
  range.count = std::max(kExposuresMin, static_cast<int>(std::ceil(range.stop - range.start)));
  return range;
}

}  // namespace tessera
