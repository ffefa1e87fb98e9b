// The way of a ray through the cells of a regular grid.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "renderer/math/bounds.h"
#include "renderer/math/vec.h"

namespace tessera {

// The cells that a ray passes, one after the other (J. Amanatides, A. Woo, "A Fast Voxel Traversal Algorithm
// for Ray Tracing", 1987). The borders of cells are at whole numbers, and the ray is in these coordinates.
class GridWalk {
 public:
  // Within `box`, which lies in [0, cells] along each axis, and t >= 0. A ray that touches only the surface
  // of the box passes no cell.
  GridWalk(Point3 o, Vec3 d, const Bounds3& box, const std::array<int, 3>& cells);

  // Where the first cell begins; infinite if there is none.
  float t_enter() const { return t_enter_; }

  struct Step {
    size_t cell = 0;  // (z * cells[1] + y) * cells[0] + x
    float t_end = 0;  // where the next cell begins
  };
  // Returns false after the last cell.
  bool Next(Step* step);

 private:
  struct Axis {
    float o = 0, inverse_d = 0;  // inverse_d is 0 if the ray does not move along this axis
    float t_next = std::numeric_limits<float>::infinity();  // of the next border
    int cell = 0, cells = 1, direction = 1, stride = 1;

    void FindNextBorder() {
      if (inverse_d != 0) t_next = (static_cast<float>(cell + (direction > 0 ? 1 : 0)) - o) * inverse_d;
    }
  };

  std::array<Axis, 3> axes_;
  float t_ = 0, t_enter_ = std::numeric_limits<float>::infinity(), t_exit_ = 0;
};

inline GridWalk::GridWalk(Point3 o, Vec3 d, const Bounds3& box, const std::array<int, 3>& cells) {
  float enter = 0, exit = std::numeric_limits<float>::max();
  int stride = 1;
  for (int i = 0; i < 3; ++i) {
    Axis& axis = axes_[i];
    axis.o = o[i];
    axis.cells = cells[i];
    axis.stride = stride;
    stride *= cells[i];
    const float inverse = 1 / d[i];
    if (!std::isfinite(inverse)) {
      if (!(o[i] >= box.min[i] && o[i] <= box.max[i])) return;
      continue;
    }
    axis.inverse_d = inverse;
    axis.direction = inverse > 0 ? 1 : -1;
    const float to_min = (box.min[i] - o[i]) * inverse, to_max = (box.max[i] - o[i]) * inverse;
    enter = std::max(enter, std::min(to_min, to_max));
    exit = std::min(exit, std::max(to_min, to_max));
  }
  if (!(enter < exit)) return;
  for (int i = 0; i < 3; ++i) {
    Axis& axis = axes_[i];
    const float last = static_cast<float>(axis.cells - 1);
    axis.cell = static_cast<int>(std::clamp(o[i] + d[i] * enter, 0.0f, last));
    axis.FindNextBorder();
  }
  t_ = t_enter_ = enter;
  t_exit_ = exit;
}

inline bool GridWalk::Next(Step* step) {
  if (!(t_ < t_exit_)) return false;
  const int first = axes_[0].t_next < axes_[1].t_next ? 0 : 1;
  Axis& axis = axes_[first].t_next < axes_[2].t_next ? axes_[first] : axes_[2];
  const int cell =
      axes_[0].cell * axes_[0].stride + axes_[1].cell * axes_[1].stride + axes_[2].cell * axes_[2].stride;
  step->cell = static_cast<size_t>(cell);
  t_ = std::max(t_, std::min(axis.t_next, t_exit_));
  step->t_end = t_;
  axis.cell += axis.direction;
  if (axis.cell < 0 || axis.cell >= axis.cells) t_exit_ = t_;
  axis.FindNextBorder();
  return true;
}

}  // namespace tessera
