#include "renderer/medium/grid_placement.h"

#include <fmt/format.h>

#include "renderer/math/flat_transform.h"

namespace tessera {

GridPlacement GridPlacement::Over(const Bounds3& bounds, const GridSize& size,
                                  const Transform& render_from_medium) {
  constexpr float kHalf = 0.5f;  // of a voxel: its centre is at a whole position
  const Vec3 sides = bounds.Diagonal();
  Vec3 voxels;
  Bounds3 box;
  for (int i = 0; i < 3; ++i) {
    voxels[i] = static_cast<float>(size[i]);
    box.min[i] = kHalf;
    box.max[i] = voxels[i] + kHalf;
  }
  const Transform position_from_medium = Translate({kHalf, kHalf, kHalf}) *
                                         Scale(voxels.x / sides.x, voxels.y / sides.y, voxels.z / sides.z) *
                                         Translate(-bounds.min);
  return {position_from_medium * render_from_medium.Inverse(), box};
}

float GridPlacement::LongestDiagonal() const {
  const Vec3 d = box_.Diagonal();
  const Transform render_from_position = position_from_render_.Inverse();
  float longest = 0;
  for (const Vec3& diagonal : {d, Vec3{-d.x, d.y, d.z}, Vec3{d.x, -d.y, d.z}, Vec3{d.x, d.y, -d.z}})
    longest = std::max(longest, Length(render_from_position.ToVector(diagonal)));
  return longest;
}

void CheckMeanFreePaths(const GridPlacement& placement, float sigma_max, ParameterReader& reader) {
  const float count = placement.LongestDiagonal() * sigma_max;
  if (count <= kMeanFreePathsMax) return;
  reader.Fail(
      fmt::format("the medium is too dense: up to {:.3g} mean free paths across, at most {:.3g} are followed",
                  count, kMeanFreePathsMax));
}

Bounds3 ReadGridBounds(ParameterReader& reader, const Transform& render_from_medium) {
  const Point3 p0 = reader.Point3Value("p0", {0, 0, 0}), p1 = reader.Point3Value("p1", {1, 1, 1});
  const Bounds3 bounds{Min(p0, p1), Max(p0, p1)};
  bool is_box = true;
  for (int i = 0; i < 3; ++i) {
    const float side = bounds.max[i] - bounds.min[i];
    is_box &= std::isfinite(side) && std::isfinite(kGridSideMax / side);
  }
  if (!is_box)
    reader.FailAt("p1", "p0 and p1 must be corners of a box whose sides are neither 0 nor infinite");
  if (IsFlat(render_from_medium)) reader.Fail("the transformation of the medium has no inverse");
  return reader.failed() ? Bounds3{{0, 0, 0}, {1, 1, 1}} : bounds;
}

GridSize ReadGridSize(ParameterReader& reader) {
  GridSize size{};
  constexpr const char* kNames[] = {"nx", "ny", "nz"};
  for (int i = 0; i < 3; ++i) {
    size[i] = reader.Integer(kNames[i], 1);
    if (size[i] < 1 || size[i] > kGridSideMax) {
      reader.FailAt(kNames[i],
                    fmt::format("{} must lie between 1 and {}, not {}", kNames[i], kGridSideMax, size[i]));
    }
  }
  return reader.failed() ? GridSize{1, 1, 1} : size;
}

}  // namespace tessera
