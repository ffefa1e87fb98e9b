// Upper bounds of a density, over the cells of a coarse grid.
#pragma once

#include <vector>

#include "renderer/math/bounds.h"
#include "renderer/medium/grid_walk.h"
#include "renderer/medium/voxel_grid.h"

namespace tessera {

// Covers the positions of a voxel grid (VoxelGrid) in cubes of 2^n cells of interpolation, as few as keep
// each side within kMajorantCellsMax. Filled once, then immutable.
class MajorantGrid {
 public:
  MajorantGrid() = default;
  // Of a voxel grid of this size. All bounds are the same.
  explicit MajorantGrid(const GridSize& size, float bound = 0);

  // Raises the bound of what the cell of interpolation is in.
  void Raise(const GridSize& cell, float bound) {
    float& largest = bounds_[IndexOf(cell)];
    largest = std::max(largest, bound);
  }
  // Adds the bounds of another grid of the same size.
  void Add(const MajorantGrid& other);

  float operator[](size_t cell) const { return bounds_[cell]; }
  // The bound at a point in positions.
  float At(Point3 position) const;
  float Max() const { return *std::max_element(bounds_.begin(), bounds_.end()); }

  // The cells along a ray in positions, within `box`.
  GridWalk Walk(Point3 o, Vec3 d, const Bounds3& box) const {
    return {o * per_position_, d * per_position_, {box.min * per_position_, box.max * per_position_}, cells_};
  }

 private:
  size_t IndexOf(const GridSize& cell) const {
    const int index =
        ((cell[2] >> shift_) * cells_[1] + (cell[1] >> shift_)) * cells_[0] + (cell[0] >> shift_);
    return static_cast<size_t>(index);
  }

  int shift_ = 0;
  float per_position_ = 1;  // cells
  GridSize cells_{1, 1, 1};
  std::vector<float> bounds_{0};
};

constexpr int kMajorantCellsMax = 64;  // along an axis: 1 MB in all

// The bounds of bound(value) over a grid. Interpolation in float may exceed its corners by rounding errors,
// which the bounds allow for.
template <typename T, typename Bound>
MajorantGrid MajorantsOf(const VoxelGrid<T>& grid, const Bound& bound) {
  constexpr float kRoundingErrors = 1 + 1e-5f;
  MajorantGrid majorants(grid.size());
  grid.VisitCells(
      bound, [&](const GridSize& cell, float largest) { majorants.Raise(cell, largest * kRoundingErrors); });
  return majorants;
}

}  // namespace tessera
