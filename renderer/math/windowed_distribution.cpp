#include "renderer/math/windowed_distribution.h"

#include <algorithm>
#include <cmath>

#include "renderer/util/check.h"

namespace tessera {
namespace {

uint32_t CellOf(double x, uint32_t cells) {
  return std::min(static_cast<uint32_t>(x), cells - 1);
}

// The last cell that an interval ending at x, in cells, covers a part of.
uint32_t LastCell(double x, uint32_t first, uint32_t cells) {
  const uint32_t cell = CellOf(x, cells);
  return cell > first && static_cast<double>(cell) == x ? cell - 1 : cell;
}

// Where `target` lies between a, at x0, and b, at x1.
double Interpolate(double target, double a, double b, double x0, double x1) {
  if (!(b > a)) return x0;
  return std::clamp(x0 + (x1 - x0) * ((target - a) / (b - a)), x0, x1);
}

// A coordinate of the unit square that is in `cell` of `cells` again, whatever is rounded.
float CoordinateOf(double x, uint32_t cell, uint32_t cells) {
  float unit = static_cast<float>(x / cells);
  const auto cell_at = [&] { return CellOf(static_cast<double>(unit) * cells, cells); };
  while (cell_at() < cell) unit = std::nextafterf(unit, 2.0f);
  while (unit >= 1 || cell_at() > cell) unit = std::nextafterf(unit, 0.0f);
  return unit;
}

}  // namespace

WindowedDistribution2D::WindowedDistribution2D(std::span<const float> weights, uint32_t width,
                                               uint32_t height)
    : width_(width), height_(height) {
  TESSERA_CHECK(width > 0 && height > 0 && weights.size() == size_t{width} * height);
  const size_t stride = size_t{width} + 1;
  sums_.resize(stride * (size_t{height} + 1));
  for (size_t y = 0; y < height; ++y) {
    double row = 0;
    for (size_t x = 0; x < width; ++x) {
      row += weights[y * width + x];
      sums_[(y + 1) * stride + x + 1] = sums_[y * stride + x + 1] + row;
    }
  }
}

WindowedDistribution2D::Box WindowedDistribution2D::CellsOf(const Window& window) const {
  const auto cells = [](float x, uint32_t count) { return std::clamp<double>(x, 0, 1) * count; };
  return {cells(window.min.x, width_), cells(window.min.y, height_), cells(window.max.x, width_),
          cells(window.max.y, height_)};
}

double WindowedDistribution2D::SumTo(double x, double y) const {
  const uint32_t cell_x = CellOf(x, width_), cell_y = CellOf(y, height_);
  const double dx = x - cell_x, dy = y - cell_y;
  const double* const above = &sums_[size_t{cell_y} * (size_t{width_} + 1) + cell_x];
  const double* const below = above + width_ + 1;
  const double left = above[0] + (below[0] - above[0]) * dy;
  const double right = above[1] + (below[1] - above[1]) * dy;
  return left + (right - left) * dx;
}

double WindowedDistribution2D::Sum(const Box& box) const {
  return std::max(
      0.0, (SumTo(box.x1, box.y1) - SumTo(box.x0, box.y1)) - (SumTo(box.x1, box.y0) - SumTo(box.x0, box.y0)));
}

double WindowedDistribution2D::CellSum(uint32_t x, uint32_t y) const {
  const double* const above = &sums_[size_t{y} * (size_t{width_} + 1) + x];
  const double* const below = above + width_ + 1;
  return std::max(0.0, (below[1] - above[1]) - (below[0] - above[0]));
}

template <typename SumBefore>
uint32_t WindowedDistribution2D::FindCell(uint32_t low, uint32_t high, double target,
                                          const SumBefore& sum_before) {
  while (low < high) {
    const uint32_t middle = low + (high - low + 1) / 2;
    if (sum_before(middle) <= target)
      low = middle;
    else
      high = middle - 1;
  }
  return low;
}

std::optional<WindowedDistribution2D::Drawn> WindowedDistribution2D::Sample(Point2 u,
                                                                            const Window& window) const {
  const Box box = CellsOf(window);
  const double total = Sum(box);
  if (!(total > 0)) return std::nullopt;
  const auto left_of = [&](double x) { return Sum({box.x0, box.y0, x, box.y1}); };
  const double target = u.x * total;
  const uint32_t first_x = CellOf(box.x0, width_);
  const uint32_t x = FindCell(first_x, LastCell(box.x1, first_x, width_), target, left_of);
  const double x0 = std::max<double>(x, box.x0), x1 = std::min<double>(x + 1.0, box.x1);
  const double px = Interpolate(target, left_of(x0), left_of(x1), x0, x1);

  const auto above = [&](double y) { return Sum({static_cast<double>(x), box.y0, x + 1.0, y}); };
  const double column_target = u.y * above(box.y1);
  const uint32_t first_y = CellOf(box.y0, height_);
  const uint32_t y = FindCell(first_y, LastCell(box.y1, first_y, height_), column_target, above);
  const double y0 = std::max<double>(y, box.y0), y1 = std::min<double>(y + 1.0, box.y1);
  const double py = Interpolate(column_target, above(y0), above(y1), y0, y1);

  const double density = CellSum(x, y) * width_ * height_ / total;
  if (!(density > 0)) return std::nullopt;
  return Drawn{
      {CoordinateOf(px, x, width_), CoordinateOf(py, y, height_)}, static_cast<float>(density), x, y};
}

float WindowedDistribution2D::Pdf(Point2 p, const Window& window) const {
  const bool is_inside =
      p.x >= window.min.x && p.x <= window.max.x && p.y >= window.min.y && p.y <= window.max.y;
  if (!is_inside) return 0;
  const double total = Sum(CellsOf(window));
  if (!(total > 0)) return 0;
  const uint32_t x = CellOf(static_cast<double>(p.x) * width_, width_);
  const uint32_t y = CellOf(static_cast<double>(p.y) * height_, height_);
  return static_cast<float>(CellSum(x, y) * width_ * height_ / total);
}

}  // namespace tessera
