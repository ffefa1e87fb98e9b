#include "renderer/denoise/strip_sums.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr int kRows = kStripHeight + 2 * kWindowRadius;
constexpr float kWeightMin = 1e-20f;

}  // namespace

StripSums::StripSums(int width, size_t signals) : width_(width), sums_(1 + signals) {
  for (Plane& plane : sums_) plane.Resize(0, width, -kWindowRadius, kRows);
  Clear(-kWindowRadius, kRows);
}

void StripSums::NextStrip() {
  for (Plane& plane : sums_) {
    for (int y = -kWindowRadius; y < kWindowRadius; ++y)
      std::copy_n(plane.At(0, y + kStripHeight), width_, plane.At(0, y));
  }
  Clear(kWindowRadius, kRows - 2 * kWindowRadius);
}

void StripSums::Add(const TileContributions& tile, int x0, int y0) {
  constexpr int kSide = TileContributions::kSide;
  const int first = std::max(0, kWindowRadius - x0);
  const int last = std::min(kSide, width_ - x0 + kWindowRadius);
  for (size_t s = 0; s < sums_.size(); ++s) {
    for (int y = 0; y < kSide; ++y) {
      float* const to = sums_[s].At(x0 - kWindowRadius + first, y0 + y - kWindowRadius);
      const float* const from = &tile.sums[s][static_cast<size_t>(y)][static_cast<size_t>(first)];
      for (int x = 0; x < last - first; ++x) to[x] += from[x];
    }
  }
}

void StripSums::FitRow(size_t signal, int y, float* fit, size_t step) const {
  const float *const weight = sums_[0].At(0, y), *const sum = sums_[1 + signal].At(0, y);
  for (int x = 0; x < width_; ++x, fit += step) *fit = sum[x] / std::max(weight[x], kWeightMin);
}

void StripSums::Clear(int y0, int rows) {
  for (Plane& plane : sums_)
    std::fill_n(plane.At(0, y0), static_cast<size_t>(rows) * static_cast<size_t>(width_), 0.0f);
}

}  // namespace tessera
