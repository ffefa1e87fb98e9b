#include "renderer/medium/vdb_grid_filler.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "renderer/util/load_budget.h"

namespace tessera {

GridSize IndexBox::Size() const {
  return {max[0] - min[0] + 1, max[1] - min[1] + 1, max[2] - min[2] + 1};
}

std::string BoxProblem(const IndexBox& box) {
  for (int i = 0; i < 3; ++i) {
    const int64_t side = int64_t{box.max[i]} - box.min[i] + 1;
    if (side < 1) return "has no active voxels";
    if (side > kVdbSideMax) return fmt::format("is {} voxels long, at most {} are read", side, kVdbSideMax);
  }
  const GridSize size = box.Size();
  if (VoxelGrid<float>::BlockCount(size) <= kVdbBlocksMax) return "";
  return fmt::format("is too large: {} x {} x {} voxels", size[0], size[1], size[2]);
}

bool VdbGridFiller::Set(int64_t x, int64_t y, int64_t z, float value) {
  if (value == 0) return true;
  const IndexBox& box = grid_.box;
  if (x < box.min[0] || x > box.max[0] || y < box.min[1] || y > box.max[1] || z < box.min[2] ||
      z > box.max[2])
    return true;
  if (!std::isfinite(value) || (value < 0 && !may_be_negative_)) {
    problem_ = fmt::format("it has the value {} at ({}, {}, {}), expected a finite number{}", value, x, y, z,
                           may_be_negative_ ? "" : " of at least 0");
    return false;
  }
  if (++voxels_ > kVdbVoxelsMax) {
    problem_ = fmt::format("more than {} voxels are not zero", kVdbVoxelsMax);
    return false;
  }
  grid_.voxels.Set(static_cast<int>(x - box.min[0]), static_cast<int>(y - box.min[1]),
                   static_cast<int>(z - box.min[2]), value);
  return true;
}

bool VdbGridFiller::Fill(const VdbOrigin& origin, int64_t side, float value) {
  if (value == 0) return true;
  std::array<int64_t, 3> begin{}, end{};
  for (size_t i = 0; i < 3; ++i) {
    begin[i] = std::max<int64_t>(origin[i], grid_.box.min[i]);
    end[i] = std::min<int64_t>(origin[i] + side, int64_t{grid_.box.max[i]} + 1);
    if (begin[i] >= end[i]) return true;
  }
  for (int64_t x = begin[0]; x < end[0]; ++x) {
    CheckLoadBudget();
    for (int64_t y = begin[1]; y < end[1]; ++y) {
      for (int64_t z = begin[2]; z < end[2]; ++z) {
        if (!Set(x, y, z, value)) return false;
      }
    }
  }
  return true;
}

}  // namespace tessera
