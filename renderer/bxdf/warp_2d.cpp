#include "renderer/bxdf/warp_2d.h"

#include <algorithm>
#include <cmath>

#include "renderer/util/hash.h"

namespace tessera {
namespace {

// The x in [0, 1] up to which the line from a at 0 to b at 1 integrates to `area`.
float InvertLine(float area, float a, float b) {
  if (std::abs(a - b) < 1e-4f * (a + b)) return std::clamp(2 * area / (a + b), 0.0f, 1.0f);
  return std::clamp((a - SafeSqrt(a * a - 2 * area * (a - b))) / (a - b), 0.0f, 1.0f);
}

float LineIntegral(float x, float a, float b) {
  return x * (a + 0.5f * x * (b - a));
}

// The last i in [0, count - 2] for which before(i) <= u; before rises.
template <typename Before>
int FindInterval(int count, float u, const Before& before) {
  int low = 0, high = count - 1;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (before(middle) <= u ? low : high) = middle;
  }
  return low;
}

}  // namespace

template <int kParameters>
Warp2D<kParameters>::Warp2D(Table table, bool normalizes)
    : columns_(table.columns),
      rows_(table.rows),
      parameter_values_(std::move(table.parameter_values)),
      values_(std::move(table.values)) {
  if (!normalizes) return;
  const size_t grids = values_.size() / GridSize();
  before_column_.resize(values_.size());
  before_row_.resize(grids * static_cast<size_t>(rows_));
  for (size_t grid = 0; grid < grids; ++grid) Accumulate(grid);
}

// The integrals of one grid by the trapezoidal rule, in units of cells, and its scaling to a density.
template <int kParameters>
void Warp2D<kParameters>::Accumulate(size_t grid) {
  const auto columns = static_cast<size_t>(columns_), rows = static_cast<size_t>(rows_);
  float* const values = values_.data() + grid * GridSize();
  float* const before_column = before_column_.data() + grid * GridSize();
  float* const before_row = before_row_.data() + grid * rows;
  std::vector<double> row_integrals(rows);
  double total = 0;
  for (size_t row = 0; row < rows; ++row) {
    for (size_t x = row * columns; x + 1 < (row + 1) * columns; ++x) {
      row_integrals[row] += 0.5 * (static_cast<double>(values[x]) + static_cast<double>(values[x + 1]));
    }
    if (row > 0) total += 0.5 * (row_integrals[row - 1] + row_integrals[row]);
  }
  const double scale = total > 0 ? 1 / total : 0;
  double above = 0;
  for (size_t row = 0; row < rows; ++row) {
    double sum = 0;
    for (size_t x = row * columns; x < (row + 1) * columns; ++x) {
      if (x > row * columns)
        sum += 0.5 * (static_cast<double>(values[x - 1]) + static_cast<double>(values[x]));
      before_column[x] = static_cast<float>(sum * scale);
    }
    if (row > 0) above += 0.5 * (row_integrals[row - 1] + row_integrals[row]);
    before_row[row] = static_cast<float>(above * scale);
  }
  for (size_t i = 0; i < GridSize(); ++i) values[i] = static_cast<float>(values[i] * scale);
}

template <int kParameters>
typename Warp2D<kParameters>::Blend Warp2D<kParameters>::BlendAt(const Parameters& parameters) const {
  Blend blend;
  blend.grid[0] = 0;
  blend.weight[0] = 1;
  blend.count = 1;
  for (size_t dimension = 0; dimension < kParameters; ++dimension) {
    const std::vector<float>& known = parameter_values_[dimension];
    size_t below = 0;
    float t = 0;
    if (known.size() > 1) {
      const float value = parameters[dimension];
      below = static_cast<size_t>(FindInterval(static_cast<int>(known.size()), value,
                                               [&](int i) { return known[static_cast<size_t>(i)]; }));
      t = std::clamp((value - known[below]) / (known[below + 1] - known[below]), 0.0f, 1.0f);
    }
    const size_t count = blend.count;
    for (size_t i = 0; i < count; ++i) {
      const size_t first = blend.grid[i] * known.size() + below;
      const float weight = blend.weight[i];
      blend.grid[i] = first;
      blend.weight[i] = weight * (1 - t);
      if (t == 0) continue;
      blend.grid[blend.count] = first + 1;
      blend.weight[blend.count++] = weight * t;
    }
  }
  return blend;
}

template <int kParameters>
typename Warp2D<kParameters>::Cell Warp2D<kParameters>::CellAt(Point2 p) const {
  const float x = std::clamp(p.x, 0.0f, 1.0f) * static_cast<float>(columns_ - 1);
  const float y = std::clamp(p.y, 0.0f, 1.0f) * static_cast<float>(rows_ - 1);
  const int column = std::min(static_cast<int>(x), columns_ - 2),
            row = std::min(static_cast<int>(y), rows_ - 2);
  return {column, row, x - static_cast<float>(column), y - static_cast<float>(row)};
}

template <int kParameters>
Point2 Warp2D<kParameters>::PointOf(const Cell& cell) const {
  return {(static_cast<float>(cell.column) + cell.x) / static_cast<float>(columns_ - 1),
          (static_cast<float>(cell.row) + cell.y) / static_cast<float>(rows_ - 1)};
}

template <int kParameters>
float Warp2D<kParameters>::Value(const Blend& blend, int column, int row) const {
  const int point = row * columns_ + column;
  const auto offset = static_cast<size_t>(point);
  float sum = 0;
  for (size_t i = 0; i < blend.count; ++i)
    sum += blend.weight[i] * values_[blend.grid[i] * GridSize() + offset];
  return sum;
}

template <int kParameters>
float Warp2D<kParameters>::BeforeColumn(const Blend& blend, int column, int row) const {
  const int point = row * columns_ + column;
  const auto offset = static_cast<size_t>(point);
  float sum = 0;
  for (size_t i = 0; i < blend.count; ++i) {
    sum += blend.weight[i] * before_column_[blend.grid[i] * GridSize() + offset];
  }
  return sum;
}

template <int kParameters>
float Warp2D<kParameters>::BeforeRow(const Blend& blend, int row) const {
  float sum = 0;
  for (size_t i = 0; i < blend.count; ++i) {
    sum +=
        blend.weight[i] * before_row_[blend.grid[i] * static_cast<size_t>(rows_) + static_cast<size_t>(row)];
  }
  return sum;
}

template <int kParameters>
float Warp2D<kParameters>::DensityAt(const Blend& blend, const Cell& c) const {
  const float top = Lerp(c.x, Value(blend, c.column, c.row), Value(blend, c.column + 1, c.row));
  const float bottom = Lerp(c.x, Value(blend, c.column, c.row + 1), Value(blend, c.column + 1, c.row + 1));
  return Lerp(c.y, top, bottom);
}

template <int kParameters>
float Warp2D<kParameters>::Evaluate(Point2 p, const Parameters& parameters) const {
  const float value = DensityAt(BlendAt(parameters), CellAt(p));
  if (before_row_.empty()) return value;
  return value * static_cast<float>(columns_ - 1) * static_cast<float>(rows_ - 1);
}

template <int kParameters>
WarpPoint Warp2D<kParameters>::Sample(Point2 u, const Parameters& parameters) const {
  const Blend blend = BlendAt(parameters);
  Cell cell{};
  cell.row = FindInterval(rows_, u.y, [&](int row) { return BeforeRow(blend, row); });
  const float row_above = RowIntegral(blend, cell.row), row_below = RowIntegral(blend, cell.row + 1);
  if (!(row_above + row_below > 0)) return {};
  cell.y = InvertLine(u.y - BeforeRow(blend, cell.row), row_above, row_below);

  const auto before = [&](int column) {
    return Lerp(cell.y, BeforeColumn(blend, column, cell.row), BeforeColumn(blend, column, cell.row + 1));
  };
  const float u_x = u.x * Lerp(cell.y, row_above, row_below);
  cell.column = FindInterval(columns_, u_x, before);
  const auto value = [&](int column) {
    return Lerp(cell.y, Value(blend, column, cell.row), Value(blend, column, cell.row + 1));
  };
  const float left = value(cell.column), right = value(cell.column + 1);
  if (!(left + right > 0)) return {};
  cell.x = InvertLine(u_x - before(cell.column), left, right);
  return {PointOf(cell),
          Lerp(cell.x, left, right) * static_cast<float>(columns_ - 1) * static_cast<float>(rows_ - 1)};
}

template <int kParameters>
WarpPoint Warp2D<kParameters>::Invert(Point2 p, const Parameters& parameters) const {
  const Blend blend = BlendAt(parameters);
  const Cell cell = CellAt(p);
  const float row_above = RowIntegral(blend, cell.row), row_below = RowIntegral(blend, cell.row + 1);
  const float row = Lerp(cell.y, row_above, row_below);
  if (!(row > 0)) return {};
  const auto value = [&](int column) {
    return Lerp(cell.y, Value(blend, column, cell.row), Value(blend, column, cell.row + 1));
  };
  const float left = value(cell.column), right = value(cell.column + 1);
  const float before = Lerp(cell.y, BeforeColumn(blend, cell.column, cell.row),
                            BeforeColumn(blend, cell.column, cell.row + 1));
  const float u_x = (before + LineIntegral(cell.x, left, right)) / row;
  const float u_y = BeforeRow(blend, cell.row) + LineIntegral(cell.y, row_above, row_below);
  return {{std::clamp(u_x, 0.0f, 1.0f), std::clamp(u_y, 0.0f, 1.0f)},
          Lerp(cell.x, left, right) * static_cast<float>(columns_ - 1) * static_cast<float>(rows_ - 1)};
}

template class Warp2D<0>;
template class Warp2D<2>;
template class Warp2D<3>;

}  // namespace tessera
