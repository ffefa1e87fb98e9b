// The tree of a NanoVDB grid, read with every offset checked.
#pragma once

#include <cstring>
#include <optional>
#include <string_view>

#include "renderer/medium/vdb_grid_filler.h"

namespace tessera {

// The bytes of one grid, unpacked. Layout: NanoVDB.h of NanoVDB 32 (GridData, TreeData, RootData,
// InternalData, LeafData).
class NanoVdbTree {
 public:
  explicit NanoVdbTree(std::string_view bytes) : bytes_(bytes) {}

  // Each returns an error text, or an empty one.
  std::string ReadHeader();
  // Fills the voxels of `grid` in its box.
  std::string ReadVoxels(bool may_be_negative, VdbGrid* grid);

  const IndexBox& active_box() const { return active_box_; }
  const Matrix4& world_from_index() const { return world_from_index_; }

 private:
  // Returns nullopt beyond the end.
  template <typename T>
  std::optional<T> Load(uint64_t at) const {
    if (at > bytes_.size() || bytes_.size() - at < sizeof(T)) return std::nullopt;
    T value;
    std::memcpy(&value, bytes_.data() + at, sizeof(T));
    return value;
  }
  bool Contains(uint64_t at, uint64_t size) const {
    return at <= bytes_.size() && bytes_.size() - at >= size;
  }
  bool IsOn(uint64_t mask_at, uint32_t n) const;

  struct Level;
  // Reads a node whose first voxel has the index `origin`. Returns false and sets problem_ if something is
  // wrong.
  bool ReadNode(const Level& level, uint64_t at, const VdbOrigin& origin);
  bool ReadLeaf(uint64_t at, const VdbOrigin& origin);
  bool Fail(const std::string& problem) {
    problem_ = problem;
    return false;
  }

  std::string_view bytes_;
  uint64_t root_ = 0;
  uint32_t tiles_ = 0;
  IndexBox active_box_;
  Matrix4 world_from_index_;

  std::optional<VdbGridFiller> filler_;
  uint64_t bytes_visited_ = 0;  // a tree has each node once: no more than there are
  std::string problem_;
};

}  // namespace tessera
