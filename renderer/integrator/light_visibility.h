// Where in a scene light sampling is of little use, because lights are hidden.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderer/integrator/world.h"

namespace tessera {

// Most shadow rays of a room that is lit through a door are blocked, and cost as much as the rays that find
// light. Space is divided into cells; where no light is visible from random points in and around a cell, a
// path samples lights with a small probability only, weighted by its inverse.
//
// Cells are cubes around the origin of rendering space, where the camera is, that grow with the distance from
// it. They are examined when a path first reaches them. Thread-safe: what a cell is depends on the scene
// alone, not on the paths that reach it.
class LightVisibility {
 public:
  // `world` must outlive it and stay where it is, with its accelerator.
  explicit LightVisibility(const World& world);

  // The probability with which a path samples a light at p.
  float SamplingProbability(Point3 p) const {
    return StateOf(cells_, PlaceOf(p), &LightVisibility::ExamineCell) == Cell::kHidden ? kHiddenProbability
                                                                                       : 1;
  }

 private:
  enum class Cell : uint8_t { kUnknown, kLit, kHidden };
  // So large that what a hidden cell receives after all makes few bright pixels.
  static constexpr float kHiddenProbability = 0.125f;
  static constexpr int kLevels = 12;
  static constexpr int kHalf = 16;  // cells from the origin to the border of a level, along each axis

  // A level is a cube of cells: the points whose largest coordinate is at least a power of two but less than
  // the next. The first level has all nearer points, too, the last all farther ones. Blocks of 2 x 2 x 2
  // cells are examined first, since most are lit.
  struct Place {
    uint32_t level = 0;
    uint32_t x = 0, y = 0, z = 0;  // of the cell or block, from the lower corner of the level
  };
  struct Grid {
    uint32_t side = 0;                             // cells or blocks along an axis of a level
    mutable std::vector<std::atomic<Cell>> cells;  // level by level, z by z, y by y

    explicit Grid(uint32_t per_side)
        : side(per_side), cells(size_t{kLevels} * per_side * per_side * per_side) {}
    std::atomic<Cell>& At(const Place& place) const {
      return cells[((size_t{place.level} * side + place.z) * side + place.y) * side + place.x];
    }
  };

  // The state of a cell or block, which is examined the first time.
  Cell StateOf(const Grid& grid, const Place& place,
               Cell (LightVisibility::*examine)(const Place&) const) const {
    std::atomic<Cell>& known = grid.At(place);
    Cell cell = known.load(std::memory_order_relaxed);
    if (cell == Cell::kUnknown) {
      cell = (this->*examine)(place);
      known.store(cell, std::memory_order_relaxed);
    }
    return cell;
  }
  Place PlaceOf(Point3 p) const {
    const float distance = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    const int level = std::clamp(ExponentOf(distance) - first_exponent_, 0, kLevels - 1);
    const float inverse = inverse_size_[level];
    return {static_cast<uint32_t>(level), CellOf(p.x * inverse), CellOf(p.y * inverse),
            CellOf(p.z * inverse)};
  }
  // floor(log2(v)) of a positive number; of any other value within the exponents of floats.
  static int ExponentOf(float v) {
    constexpr int kFractionBits = 23, kBias = 127;
    return static_cast<int>(std::bit_cast<uint32_t>(v) >> kFractionBits & 0xff) - kBias;
  }
  // Of a coordinate in units of the size of a cell; of NaN 0.
  static uint32_t CellOf(float coordinate) {
    return static_cast<uint32_t>(std::min(std::max(0.0f, coordinate + kHalf), 2.0f * kHalf - 1));
  }
  Cell ExamineCell(const Place& place) const;
  Cell ExamineBlock(const Place& place) const;
  // Whether a light is visible from any of `count` random points in a cube.
  bool AnyIsLit(Point3 center, float size, int count, uint64_t seed) const;
  // Whether a random point of a random light is visible from p.
  bool IsLit(Point3 p, uint64_t random) const;

  const World& world_;
  int first_exponent_ = 0;                                 // of the first level
  float size_[kLevels] = {}, inverse_size_[kLevels] = {};  // of the cells of a level
  Grid cells_{2 * kHalf}, blocks_{kHalf};
};

}  // namespace tessera
