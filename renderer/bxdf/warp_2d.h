// Densities over the unit square, given on a grid and interpolated bilinearly, that depend on up to three
// parameters: the tables of measured BRDFs (Dupuy and Jakob, "An Adaptive Parameterization for Efficient
// Material Acquisition and Rendering", 2018).
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "renderer/math/vec.h"

namespace tessera {

// A place of the unit square and the density there.
struct WarpPoint {
  Point2 p;
  float pdf = 0;
};

// Immutable. Parameters beyond the first or last of their values count as that value.
template <int kParameters>
class Warp2D {
 public:
  using Parameters = std::array<float, kParameters>;

  struct Table {
    int columns = 0, rows = 0;  // of one grid, at least 2 each
    // Finite, and not negative if they are to be sampled. Grid after grid, the last parameter changing
    // fastest; row after row in each.
    std::vector<float> values;
    std::array<std::vector<float>, kParameters> parameter_values;  // strictly rising, at least one each
  };
  // For Evaluate alone: the values as they are.
  static Warp2D ForEvaluation(Table table) { return Warp2D(std::move(table), false); }
  // For all functions: scaled so that each grid integrates to 1, or stays 0 if it is.
  static Warp2D ForSampling(Table table) { return Warp2D(std::move(table), true); }

  // The value, or density, at a point (clamped to the square).
  float Evaluate(Point2 p, const Parameters& parameters) const;
  // Maps uniform points to points of this density. pdf is 0 if there is none.
  WarpPoint Sample(Point2 u, const Parameters& parameters) const;
  // The u that Sample maps to p, and the density at p.
  WarpPoint Invert(Point2 p, const Parameters& parameters) const;

 private:
  static constexpr size_t kCorners = size_t{1} << kParameters;

  // The grids around the parameters, with their weights. Those of weight 0 are left out.
  struct Blend {
    std::array<size_t, kCorners> grid;
    std::array<float, kCorners> weight;
    size_t count = 0;
  };
  // The four corners of a cell, and a place in it.
  struct Cell {
    int column, row;
    float x, y;
  };
  Warp2D(Table table, bool normalizes);
  void Accumulate(size_t grid);
  Blend BlendAt(const Parameters& parameters) const;
  Cell CellAt(Point2 p) const;
  Point2 PointOf(const Cell& cell) const;
  size_t GridSize() const { return static_cast<size_t>(columns_) * static_cast<size_t>(rows_); }
  float Value(const Blend& blend, int column, int row) const;
  // The integral over a row, and over its columns before `column`.
  float RowIntegral(const Blend& blend, int row) const { return BeforeColumn(blend, columns_ - 1, row); }
  float BeforeColumn(const Blend& blend, int column, int row) const;
  // The integral over all rows before `row`.
  float BeforeRow(const Blend& blend, int row) const;
  float DensityAt(const Blend& blend, const Cell& cell) const;

  int columns_, rows_;
  std::array<std::vector<float>, kParameters> parameter_values_;
  std::vector<float> values_;
  std::vector<float> before_column_;  // as values_
  std::vector<float> before_row_;     // a row of each grid after the other
};

extern template class Warp2D<0>;
extern template class Warp2D<2>;
extern template class Warp2D<3>;

}  // namespace tessera
