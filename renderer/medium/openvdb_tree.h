// The tree of an OpenVDB grid, read from the bytes of its file one after the other.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/medium/vdb_grid_filler.h"

namespace tessera {

// Little-endian values one after the other. Once too few bytes are left, every function returns zeros.
class VdbCursor {
 public:
  explicit VdbCursor(std::string_view bytes) : all_(bytes), bytes_(bytes) {}

  bool failed() const { return failed_; }
  // Goes on at a place of all bytes. Returns false if it is beyond the end.
  bool MoveTo(uint64_t place) {
    if (place > all_.size()) return false;
    bytes_ = all_.substr(static_cast<size_t>(place));
    return true;
  }
  std::string_view Take(uint64_t count) {
    if (failed_ || count > bytes_.size()) {
      failed_ = true;
      return {};
    }
    const std::string_view taken = bytes_.substr(0, static_cast<size_t>(count));
    bytes_.remove_prefix(taken.size());
    return taken;
  }
  uint64_t Integer(int size) {
    const std::string_view bytes = Take(static_cast<uint64_t>(size));
    uint64_t value = 0;
    for (size_t i = bytes.size(); i > 0; --i) value = value << 8 | static_cast<uint8_t>(bytes[i - 1]);
    return value;
  }
  uint32_t Unsigned32() { return static_cast<uint32_t>(Integer(4)); }
  int32_t Signed32() { return static_cast<int32_t>(Unsigned32()); }
  float Float() { return std::bit_cast<float>(Unsigned32()); }
  double Double() { return std::bit_cast<double>(Integer(8)); }
  std::string_view Text() { return Take(Unsigned32()); }

 private:
  std::string_view all_, bytes_;  // bytes_: those that are left
  bool failed_ = false;
};

// How the values of a grid are stored (io/Compression.h of OpenVDB).
struct VdbStorage {
  uint32_t compression = 0;
  bool is_half = false;
};

// A tree of the shape 5, 4, 3: the topology first, then the values of the leaves.
class OpenVdbTree {
 public:
  OpenVdbTree(VdbCursor in, const VdbStorage& storage) : in_(in), storage_(storage) {}

  // Reads all but the leaves' values. Returns an error text, or an empty one.
  std::string ReadTopology();
  // Of the active voxels; without any, min is larger than max.
  const IndexBox& active_box() const { return active_box_; }
  // Fills the voxels of `grid` in its box. Returns an error text, or an empty one.
  std::string ReadVoxels(bool may_be_negative, VdbGrid* grid);

 private:
  struct Tile {
    VdbOrigin origin;
    int64_t side;
    float value;
  };
  struct Leaf {
    VdbOrigin origin;
    std::string_view active;  // a bit for each voxel
  };

  // An inner node: 2^side_bits children along an axis, each of 2^child_bits voxels.
  bool ReadNode(int side_bits, int child_bits, const VdbOrigin& origin);
  void ReadLeafTopology(const VdbOrigin& origin);
  // `count` values, of which those whose bit in `active` is set may be stored alone.
  bool ReadValues(std::string_view active, size_t count, std::vector<float>& values);
  // Values as they are stored.
  bool ReadStored(size_t count, std::vector<float>& values);
  void AddTile(const VdbOrigin& origin, int64_t side, float value, bool is_active);
  void Include(const VdbOrigin& first, int64_t side);

  VdbCursor in_;
  VdbStorage storage_;
  float background_ = 0;
  std::vector<Tile> tiles_;
  std::vector<Leaf> leaves_;
  IndexBox active_box_{{INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}};
};

}  // namespace tessera
