#include "renderer/compare/flip_filters.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include "renderer/util/check.h"

namespace tessera {
namespace {

constexpr double kPi = std::numbers::pi;
// Distance and width of the screen in metres, and its pixels.
constexpr double kScreenDistance = 0.7, kScreenWidth = 0.7, kScreenPixels = 3840;
constexpr double kPixelsPerDegree = kScreenDistance * kScreenPixels / kScreenWidth * kPi / 180;

// a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees of visual angle: a Gaussian of the fits of contrast
// sensitivity (2020, table 1).
struct Sensitivity {
  double a, b;
};
constexpr Sensitivity kAchromatic = {1, 0.0047};
constexpr Sensitivity kRedGreen = {1, 0.0053};
constexpr Sensitivity kBlueYellow[] = {{34.1, 0.04}, {13.5, 0.025}};

// Width of the human edge detector in degrees: two standard deviations.
constexpr double kFeatureWidth = 0.082;

template <typename Weight>
std::vector<double> Sampled(const Weight& weight) {
  std::vector<double> weights;
  for (int x = -kFlipRadius; x <= kFlipRadius; ++x) weights.push_back(weight(static_cast<double>(x)));
  return weights;
}

double Sum(const std::vector<double>& weights) {
  return std::accumulate(weights.begin(), weights.end(), 0.0);
}

// The weights, of which the positive ones sum to 1 and the negative ones to -1.
Kernel Normalized(const std::vector<double>& weights) {
  double positive = 0, negative = 0;
  for (const double weight : weights) (weight > 0 ? positive : negative) += std::abs(weight);
  Kernel kernel;
  for (const double weight : weights)
    kernel.push_back(static_cast<float>(weight > 0 ? weight / positive : weight < 0 ? weight / negative : 0));
  return kernel;
}

std::vector<double> GaussianOf(const Sensitivity& fit) {
  return Sampled([&](double x) {
    const double degrees = x / kPixelsPerDegree;
    return std::exp(-kPi * kPi * degrees * degrees / fit.b);
  });
}

}  // namespace

FlipFilters::FlipFilters()
    : achromatic(Normalized(GaussianOf(kAchromatic))), red_green(Normalized(GaussianOf(kRedGreen))) {
  double total = 0, shares[2];
  for (int i = 0; i < 2; ++i) {
    const std::vector<double> gaussian = GaussianOf(kBlueYellow[i]);
    blue_yellow[i] = Normalized(gaussian);
    shares[i] = kBlueYellow[i].a * std::sqrt(kPi / kBlueYellow[i].b) * Sum(gaussian) * Sum(gaussian);
    total += shares[i];
  }
  for (int i = 0; i < 2; ++i) blue_yellow_share[i] = static_cast<float>(shares[i] / total);
  const double deviation = 0.5 * kFeatureWidth * kPixelsPerDegree;
  const int feature_radius = static_cast<int>(std::ceil(3 * deviation));
  TESSERA_CHECK(feature_radius <= kFlipRadius);
  const auto gaussian = [&](double x) {
    return std::abs(x) > feature_radius ? 0 : std::exp(-x * x / (2 * deviation * deviation));
  };
  smooth = Normalized(Sampled(gaussian));
  edge = Normalized(Sampled([&](double x) { return -x * gaussian(x); }));
  point = Normalized(Sampled([&](double x) { return (x * x / (deviation * deviation) - 1) * gaussian(x); }));
}

Grid FilterRows(const Grid& grid, const Kernel& kernel) {
  Grid filtered(grid.width - 2 * kFlipRadius, grid.height);
  for (int y = 0; y < grid.height; ++y) {
    const float* const from = grid.Row(y);
    float* const to = filtered.Row(y);
    for (int i = 0; i <= 2 * kFlipRadius; ++i) {
      const float weight = kernel[static_cast<size_t>(i)];
      for (int x = 0; x < filtered.width; ++x) to[x] += weight * from[x + i];
    }
  }
  return filtered;
}

Grid FilterColumns(const Grid& grid, const Kernel& kernel) {
  Grid filtered(grid.width, grid.height - 2 * kFlipRadius);
  for (int y = 0; y < filtered.height; ++y) {
    float* const to = filtered.Row(y);
    for (int i = 0; i <= 2 * kFlipRadius; ++i) {
      const float weight = kernel[static_cast<size_t>(i)];
      const float* const from = grid.Row(y + i);
      for (int x = 0; x < filtered.width; ++x) to[x] += weight * from[x];
    }
  }
  return filtered;
}

}  // namespace tessera
