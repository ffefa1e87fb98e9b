#include "renderer/medium/nanovdb_tree.h"

#include "renderer/util/load_budget.h"

namespace tessera {
namespace {

constexpr uint64_t kMagic = 0x304244566f6e614e;  // "NanoVDB0"
constexpr uint32_t kFloatType = 1;
constexpr uint32_t kUnknownClass = 0, kFogVolumeClass = 2;
// Places in the grid, which starts with a GridData, followed by a TreeData.
constexpr uint64_t kMatrixAt = 384, kTranslationAt = 528, kClassAt = 632, kTypeAt = 636;
constexpr uint64_t kTreeAt = 672, kRootOffsetAt = kTreeAt + 24, kTreeEnd = kTreeAt + 64;
// Places in the root, and in each of its tiles.
constexpr uint64_t kRootSize = 64, kTableSizeAt = 24;
constexpr uint64_t kTileSize = 32, kTileChildAt = 8, kTileValueAt = 20;
constexpr int kRootTileBits = 12;  // of a voxel index within a tile of the root
// Places in a leaf, of 8 x 8 x 8 voxels.
constexpr uint64_t kLeafSize = 2144, kLeafValuesAt = 96;
constexpr int64_t kLeafSide = 8;
constexpr const char* kBeyondEnd = "an offset leads beyond its end";

}  // namespace

// Nodes between the root and the leaves.
struct NanoVdbTree::Level {
  int side_bits;   // of the children along an axis
  int child_bits;  // of the voxels of a child along an axis
  uint64_t child_mask_at, table_at, size;
  const Level* below;  // null: leaves

  static const Level kLower, kUpper;
};
constexpr NanoVdbTree::Level NanoVdbTree::Level::kLower{4, 3, 544, 1088, 33856, nullptr};
constexpr NanoVdbTree::Level NanoVdbTree::Level::kUpper{5, 7, 4128, 8256, 270400, &kLower};

bool NanoVdbTree::IsOn(uint64_t mask_at, uint32_t n) const {
  return (static_cast<unsigned char>(bytes_[mask_at + n / 8]) >> (n % 8) & 1) != 0;
}

std::string NanoVdbTree::ReadHeader() {
  if (!Contains(0, kTreeEnd)) return kBeyondEnd;
  if (*Load<uint64_t>(0) != kMagic) return "it does not start with the mark of a grid";
  if (*Load<uint32_t>(kTypeAt) != kFloatType) return "its values are not 32-bit floats, which alone are read";
  const uint32_t kind = *Load<uint32_t>(kClassAt);
  if (kind != kFogVolumeClass && kind != kUnknownClass) return "it is not a fog volume";
  for (uint64_t row = 0; row < 3; ++row) {
    for (uint64_t column = 0; column < 3; ++column)
      world_from_index_.m[row][column] =
          static_cast<float>(*Load<double>(kMatrixAt + 8 * (row * 3 + column)));
    world_from_index_.m[row][3] = static_cast<float>(*Load<double>(kTranslationAt + 8 * row));
  }
  const uint64_t offset = *Load<uint64_t>(kRootOffsetAt);
  if (offset > bytes_.size() || !Contains(kTreeAt + offset, kRootSize)) return kBeyondEnd;
  root_ = kTreeAt + offset;
  for (uint64_t i = 0; i < 3; ++i) {
    active_box_.min[i] = *Load<int32_t>(root_ + 4 * i);
    active_box_.max[i] = *Load<int32_t>(root_ + 12 + 4 * i);
  }
  tiles_ = *Load<uint32_t>(root_ + kTableSizeAt);
  if (!Contains(root_ + kRootSize, kTileSize * tiles_)) return kBeyondEnd;
  return "";
}

std::string NanoVdbTree::ReadVoxels(bool may_be_negative, VdbGrid* grid) {
  filler_.emplace(*grid, may_be_negative);
  for (uint64_t tile = 0; tile < tiles_; ++tile) {
    const uint64_t at = root_ + kRootSize + tile * kTileSize;
    const uint64_t key = *Load<uint64_t>(at);
    VdbOrigin origin{};
    for (int i = 0; i < 3; ++i) {
      // 21 bits each, of which 20 count; x is the highest.
      const auto part = static_cast<uint32_t>(key >> (21 * (2 - i))) & ((1u << 21) - 1);
      origin[i] = static_cast<int32_t>(part << kRootTileBits);
    }
    const int64_t child = *Load<int64_t>(at + kTileChildAt);
    const bool is_read =
        child == 0 ? filler_->Fill(origin, int64_t{1} << kRootTileBits, *Load<float>(at + kTileValueAt))
                   : ReadNode(Level::kUpper, root_ + static_cast<uint64_t>(child), origin);
    if (!is_read) return problem_.empty() ? filler_->problem() : problem_;
  }
  return "";
}

bool NanoVdbTree::ReadNode(const Level& level, uint64_t at, const VdbOrigin& origin) {
  CheckLoadBudget();
  if (!Contains(at, level.size)) return Fail(kBeyondEnd);
  bytes_visited_ += level.size;
  if (bytes_visited_ > bytes_.size()) return Fail("nodes occur more than once");
  const auto side = uint32_t{1} << level.side_bits;
  for (uint32_t n = 0; n < side * side * side; ++n) {
    const std::array<uint32_t, 3> place{n >> (2 * level.side_bits), n >> level.side_bits & (side - 1),
                                        n & (side - 1)};
    VdbOrigin child_origin = origin;
    for (size_t i = 0; i < 3; ++i) child_origin[i] += int64_t{place[i]} << level.child_bits;
    const uint64_t entry = at + level.table_at + uint64_t{n} * 8;
    bool is_read = false;
    if (!IsOn(at + level.child_mask_at, n)) {
      is_read = filler_->Fill(child_origin, int64_t{1} << level.child_bits, *Load<float>(entry));
    } else {
      const uint64_t child = at + static_cast<uint64_t>(*Load<int64_t>(entry));
      is_read = level.below ? ReadNode(*level.below, child, child_origin) : ReadLeaf(child, child_origin);
    }
    if (!is_read) return false;
  }
  return true;
}

bool NanoVdbTree::ReadLeaf(uint64_t at, const VdbOrigin& origin) {
  if (!Contains(at, kLeafSize)) return Fail(kBeyondEnd);
  bytes_visited_ += kLeafSize;
  if (bytes_visited_ > bytes_.size()) return Fail("nodes occur more than once");
  uint64_t value_at = at + kLeafValuesAt;
  for (int64_t x = 0; x < kLeafSide; ++x) {
    for (int64_t y = 0; y < kLeafSide; ++y) {
      for (int64_t z = 0; z < kLeafSide; ++z, value_at += sizeof(float)) {
        if (!filler_->Fill({origin[0] + x, origin[1] + y, origin[2] + z}, 1, *Load<float>(value_at)))
          return false;
      }
    }
  }
  return true;
}

}  // namespace tessera
