// Values on a regular grid, interpolated linearly. Only what is not zero takes memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "renderer/math/vec.h"

namespace tessera {

using GridSize = std::array<int, 3>;

// A block of 8 x 8 x 8 voxels, fewer along an axis with few voxels, is stored if any value in it is not zero,
// together with the values next to it: interpolation reads one block. Filled once, then immutable and shared
// by all threads.
//
// A point is given in positions: voxel i is at position i + 1 along an axis. Beyond the grid, at the
// positions 0 and size + 1, all is zero.
template <typename T>
class VoxelGrid {
 public:
  // All sides at least 1. Every value is T().
  explicit VoxelGrid(const GridSize& size) : size_(size) {
    size_t blocks = 1;
    for (int i = 0; i < 3; ++i) {
      shift_[i] = 0;
      while (shift_[i] < kBlockShift && (1 << shift_[i]) < size[i] + 1) ++shift_[i];
      blocks_[i] = (size[i] >> shift_[i]) + 1;
      blocks *= static_cast<size_t>(blocks_[i]);
      points_[i] = (1 << shift_[i]) + 1;
    }
    values_.resize(blocks);
  }

  // The number of blocks of a grid, stored or not: each takes 8 bytes.
  static double BlockCount(const GridSize& size) {
    double count = 1;
    for (const int side : size) {
      const int blocks = (side >> kBlockShift) + 1;
      count *= blocks;
    }
    return count;
  }

  // The memory of stored blocks and the table of all.
  uint64_t Bytes() const {
    const auto stored =
        std::count_if(values_.begin(), values_.end(), [](const auto& v) { return v != nullptr; });
    const int values = points_[0] * points_[1] * points_[2];
    return static_cast<uint64_t>(stored) * static_cast<uint64_t>(values) * sizeof(T) +
           values_.size() * sizeof(values_[0]);
  }

  const GridSize& size() const { return size_; }
  // Cells of interpolation along an axis: between the positions 0 and size + 1.
  int CellCount(int axis) const { return size_[axis] + 1; }

  // Sets the voxels of a box, 0 <= begin[i] < end[i] <= size[i].
  void Fill(const GridSize& begin, const GridSize& end, const T& value);
  // Sets a voxel, 0 <= x < size[0] and so on.
  void Set(int x, int y, int z, const T& value) { Fill({x, y, z}, {x + 1, y + 1, z + 1}, value); }

  // Interpolates convert(value) at a point with 0 <= p[i] <= size[i] + 1. `convert` maps T() to zero.
  template <typename Convert>
  auto Lookup(Point3 p, const Convert& convert) const;
  T Lookup(Point3 p) const {
    return Lookup(p, [](const T& value) { return value; });
  }

  // Calls visit(cell, bound) for every cell of interpolation (GridSize, cells from 0) in stored blocks, with
  // the largest bound(value) of its eight corners.
  template <typename Bound, typename Visit>
  void VisitCells(const Bound& bound, const Visit& visit) const;

 private:
  static constexpr int kBlockShift = 3;

  size_t BlockAt(int bx, int by, int bz) const {
    return (static_cast<size_t>(bz) * static_cast<size_t>(blocks_[1]) + static_cast<size_t>(by)) *
               static_cast<size_t>(blocks_[0]) +
           static_cast<size_t>(bx);
  }
  int PointAt(int x, int y, int z) const { return (z * points_[1] + y) * points_[0] + x; }
  static float Mix(float a, float b, float t) { return a * (1 - t) + b * t; }
  template <typename V>
  static V Mix(const V& a, const V& b, float t) {
    return a * (1 - t) + b * t;
  }

  GridSize size_;
  std::array<int, 3> shift_{}, blocks_{};
  std::array<int, 3> points_{};  // values of a stored block along each axis
  std::vector<std::unique_ptr<T[]>> values_;
};

template <typename T>
void VoxelGrid<T>::Fill(const GridSize& begin, const GridSize& end, const T& value) {
  // The voxels are at the positions from begin + 1 to end. A position on the border of two blocks is in both.
  const auto first_block = [&](int i) { return begin[i] >> shift_[i]; };
  const auto last_block = [&](int i) { return end[i] >> shift_[i]; };
  const auto first_point = [&](int i, int block) { return std::max(begin[i] + 1 - (block << shift_[i]), 0); };
  const auto last_point = [&](int i, int block) {
    return std::min(end[i] - (block << shift_[i]), points_[i] - 1);
  };
  const int count = points_[0] * points_[1] * points_[2];
  for (int bz = first_block(2); bz <= last_block(2); ++bz) {
    for (int by = first_block(1); by <= last_block(1); ++by) {
      for (int bx = first_block(0); bx <= last_block(0); ++bx) {
        std::unique_ptr<T[]>& values = values_[BlockAt(bx, by, bz)];
        if (!values && value == T()) continue;
        if (!values) values = std::make_unique<T[]>(static_cast<size_t>(count));
        const int row = first_point(0, bx), length = last_point(0, bx) - row + 1;
        for (int z = first_point(2, bz); z <= last_point(2, bz); ++z) {
          for (int y = first_point(1, by); y <= last_point(1, by); ++y)
            std::fill_n(values.get() + PointAt(row, y, z), length, value);
        }
      }
    }
  }
}

template <typename T>
template <typename Convert>
auto VoxelGrid<T>::Lookup(Point3 p, const Convert& convert) const {
  std::array<int, 3> block{}, point{};
  std::array<float, 3> part{};
  for (int i = 0; i < 3; ++i) {
    const float clamped = std::clamp(p[i], 0.0f, static_cast<float>(size_[i] + 1));
    const int cell = std::min(static_cast<int>(clamped), size_[i]);
    part[i] = clamped - static_cast<float>(cell);
    block[i] = cell >> shift_[i];
    point[i] = cell & ((1 << shift_[i]) - 1);
  }
  const T* const values = values_[BlockAt(block[0], block[1], block[2])].get();
  using Value = decltype(convert(T()));
  if (values == nullptr) return Value();
  const T* at = values + PointAt(point[0], point[1], point[2]);
  const int row = points_[0], layer = points_[0] * points_[1];
  const auto line = [&](const T* v) { return Mix(convert(v[0]), convert(v[1]), part[0]); };
  const Value near = Mix(line(at), line(at + row), part[1]);
  const Value far = Mix(line(at + layer), line(at + layer + row), part[1]);
  return Value(Mix(near, far, part[2]));
}

template <typename T>
template <typename Bound, typename Visit>
void VoxelGrid<T>::VisitCells(const Bound& bound, const Visit& visit) const {
  std::vector<float> bounds(static_cast<size_t>(points_[0] * points_[1] * points_[2]));
  for (int bz = 0; bz < blocks_[2]; ++bz) {
    for (int by = 0; by < blocks_[1]; ++by) {
      for (int bx = 0; bx < blocks_[0]; ++bx) {
        const T* const values = values_[BlockAt(bx, by, bz)].get();
        if (values == nullptr) continue;
        for (size_t i = 0; i < bounds.size(); ++i) bounds[i] = bound(values[i]);
        for (int z = 0; z + 1 < points_[2]; ++z) {
          for (int y = 0; y + 1 < points_[1]; ++y) {
            for (int x = 0; x + 1 < points_[0]; ++x) {
              float largest = 0;
              for (int corner = 0; corner < 8; ++corner) {
                const int at = PointAt(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2));
                largest = std::max(largest, bounds[static_cast<size_t>(at)]);
              }
              if (largest > 0) {
                visit(GridSize{(bx << shift_[0]) + x, (by << shift_[1]) + y, (bz << shift_[2]) + z}, largest);
              }
            }
          }
        }
      }
    }
  }
}

}  // namespace tessera
