// A piecewise constant density on the unit square, restricted to a window that may differ from sample to
// sample (Pharr, Jakob, Humphreys 2023, section A.5.6). Immutable once built.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "renderer/math/vec.h"

namespace tessera {

// The density is that of the table of running sums, to which both samples and Pdf refer: what is lost to
// rounding is lost in both. Sums are doubles, so that small windows of large tables keep their precision.
class WindowedDistribution2D {
 public:
  // A part of the unit square, min <= max.
  struct Window {
    Point2 min{0, 0}, max{1, 1};
  };
  struct Drawn {
    Point2 p;       // in the window
    float pdf = 0;  // density at p per area of the square, above 0
    uint32_t x = 0, y = 0;
  };

  WindowedDistribution2D() = default;
  // `weights` holds height rows of width values, finite and not negative.
  WindowedDistribution2D(std::span<const float> weights, uint32_t width, uint32_t height);

  // u in [0, 1)^2. Returns nullopt if the weights in the window are 0.
  std::optional<Drawn> Sample(Point2 u, const Window& window) const;
  // The density at p; 0 outside the window.
  float Pdf(Point2 p, const Window& window) const;
  size_t bytes() const { return sums_.size() * sizeof(double); }

 private:
  // A rectangle in cells: the window times the size of the table.
  struct Box {
    double x0, y0, x1, y1;
  };

  Box CellsOf(const Window& window) const;
  // The integral of the weights over [0, x] x [0, y], which are in cells.
  double SumTo(double x, double y) const;
  double Sum(const Box& box) const;
  double CellSum(uint32_t x, uint32_t y) const;
  // The last of the cells `low` to `high` whose start has at most `target` of the weights before it, which
  // `sum_before` returns.
  template <typename SumBefore>
  static uint32_t FindCell(uint32_t low, uint32_t high, double target, const SumBefore& sum_before);

  uint32_t width_ = 0, height_ = 0;
  std::vector<double> sums_;  // (width + 1) x (height + 1): of all cells left of and above a corner
};

}  // namespace tessera
