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

bool VdbGridFiller::Fill(const VdbOrigin& origin, int64_t side, float value) {
  CheckLoadBudget();
  if (value == 0) return true;
  GridSize begin{}, end{};
  int64_t voxels = 1;
  for (size_t i = 0; i < 3; ++i) {
    const int64_t box_min = grid_.box.min[i], box_end = int64_t{grid_.box.max[i]} + 1;
    const int64_t first = std::max(origin[i], box_min), last = std::min(origin[i] + side, box_end);
    if (first >= last) return true;
    begin[i] = static_cast<int>(first - box_min);
    end[i] = static_cast<int>(last - box_min);
    voxels *= last - first;
  }
  if (!std::isfinite(value) || (value < 0 && !may_be_negative_)) {
    const std::array<int, 3>& min = grid_.box.min;
    problem_ = fmt::format("it has the value {} at ({}, {}, {}), expected a finite number{}", value,
                           min[0] + begin[0], min[1] + begin[1], min[2] + begin[2],
                           may_be_negative_ ? "" : " of at least 0");
    return false;
  }
  voxels_ += voxels;
  if (voxels_ > kVdbVoxelsMax) {
    problem_ = fmt::format("more than {} voxels are not zero", kVdbVoxelsMax);
    return false;
  }
  grid_.voxels.Fill(begin, end, value);
  return true;
}

}  // namespace tessera
