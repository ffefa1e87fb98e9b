// Sparse grids from NanoVDB files (.nvdb).
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "renderer/math/transform.h"
#include "renderer/medium/voxel_grid.h"
#include "renderer/util/result.h"

namespace tessera {

constexpr int kVdbSideMax = 1 << 14;       // voxels along an axis: far beyond published data
constexpr double kVdbBlocksMax = 1 << 24;  // of 8 x 8 x 8 voxels, in the box of a grid: 128 MB of pointers
constexpr int64_t kVdbVoxelsMax = int64_t{1} << 28;   // that are not zero: some 1.5 GB
constexpr uint64_t kVdbBytesMax = uint64_t{4} << 30;  // of one grid, unpacked
constexpr uint64_t kVdbExpansionMax = 1100;           // unpacked bytes per byte: deflate reaches 1032

// Voxel indices, both included.
struct IndexBox {
  std::array<int, 3> min{}, max{};
  GridSize Size() const;
};

struct VdbGrid {
  VoxelGrid<float> voxels;  // those of `box`
  IndexBox box;
  Transform world_from_index;
};

// Reads the grid `name` of the bytes of a NanoVDB file of version 32, which are untrusted; within `box` if
// given, otherwise within the bounds of its active voxels. Values must be finite and, unless
// `may_be_negative`, at least 0. Returns null if the file has no grid of this name. Errors start with `file`.
Result<std::shared_ptr<const VdbGrid>> ReadNanoVdb(std::string_view bytes, const std::string& file,
                                                   const std::string& name,
                                                   const std::optional<IndexBox>& box, bool may_be_negative);

}  // namespace tessera
