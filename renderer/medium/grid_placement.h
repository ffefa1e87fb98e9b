// Where a grid is.
#pragma once

#include "renderer/description/parameter_reader.h"
#include "renderer/math/bounds.h"
#include "renderer/math/ray.h"
#include "renderer/math/transform.h"
#include "renderer/medium/majorant_grid.h"

namespace tessera {

// Maps rays of the scene to the positions of a grid.
class GridPlacement {
 public:
  GridPlacement() = default;
  // `box`: the part of the grid that is there, in positions.
  GridPlacement(const Transform& position_from_render, const Bounds3& box)
      : position_from_render_(position_from_render), box_(box) {}
  // A grid over the box from p0 to p1 in the space of the medium, whose voxels have their centres half a
  // voxel from its surface.
  static GridPlacement Over(const Bounds3& bounds, const GridSize& size, const Transform& render_from_medium);

  const Bounds3& box() const { return box_; }
  // The length of the longest diagonal of the box, in scene units.
  float LongestDiagonal() const;
  Point3 PositionOf(Point3 p) const { return position_from_render_.ToPoint(p); }
  // The direction of a ray per unit of its length, in positions.
  Vec3 DirectionOf(Vec3 d) const { return position_from_render_.ToVector(d * (1 / Length(d))); }

 private:
  Transform position_from_render_;
  Bounds3 box_;
};

// Reads `p0` and `p1`. Remembers an error if they are not the corners of a box, or if the map to render space
// has no inverse; the bounds are then those of the default.
Bounds3 ReadGridBounds(ParameterReader& reader, const Transform& render_from_medium);

// Remembers an error if a ray through the grid may have more than kMeanFreePathsMax collisions, which take
// time even if all of them are null. `sigma_max`: the largest coefficient of scattering plus absorption.
void CheckMeanFreePaths(const GridPlacement& placement, float sigma_max, ParameterReader& reader);
constexpr float kMeanFreePathsMax = 1e6f;  // across a grid: some 30 ms

// Reads `nx`, `ny` and `nz`. Remembers an error and returns 1 x 1 x 1 if they are not in [1, kGridSideMax].
GridSize ReadGridSize(ParameterReader& reader);
constexpr int kGridSideMax = 1 << 16;  // voxels

}  // namespace tessera
