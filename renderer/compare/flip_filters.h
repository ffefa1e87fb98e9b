// The filters of FLIP and how they are applied (flip.h names the papers). All are sums of separable ones.
#pragma once

#include <cstddef>
#include <vector>

namespace tessera {

// A rectangle of values, row by row.
struct Grid {
  int width = 0, height = 0;
  std::vector<float> values;

  Grid(int width_, int height_) : width(width_), height(height_), values(size_t(width_) * size_t(height_)) {}
  float* Row(int y) { return values.data() + static_cast<size_t>(y) * static_cast<size_t>(width); }
  const float* Row(int y) const {
    return values.data() + static_cast<size_t>(y) * static_cast<size_t>(width);
  }
};

// Pixels around each that the filters look at.
constexpr int kFlipRadius = 10;

// 2 * kFlipRadius + 1 weights.
using Kernel = std::vector<float>;

struct FlipFilters {
  // Contrast sensitivity of the achromatic, red-green and blue-yellow channels: Gaussians. The last is
  // a sum of two, with these shares.
  Kernel achromatic, red_green, blue_yellow[2];
  float blue_yellow_share[2] = {};
  // Detectors of edges and points: one of these along an axis and `smooth` across it.
  Kernel edge, point, smooth;

  FlipFilters();
};

// The grid filtered along its rows, or along its columns. Only values whose whole neighbourhood is in `grid`
// are computed, so that the result is 2 * kFlipRadius narrower, or less high.
Grid FilterRows(const Grid& grid, const Kernel& kernel);
Grid FilterColumns(const Grid& grid, const Kernel& kernel);

}  // namespace tessera
