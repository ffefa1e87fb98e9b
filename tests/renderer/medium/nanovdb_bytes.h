// NanoVDB files of small grids, written byte by byte.
#pragma once

#include <zlib.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tessera {

using VoxelIndex = std::array<int, 3>;

// The bytes of a grid of floats whose voxels from `first` to `last` are value(index) and active. Index (x, y,
// z) is at (x, y, z) * voxel_size.
class NanoVdbGridWriter {
 public:
  NanoVdbGridWriter(const std::string& name, const VoxelIndex& first, const VoxelIndex& last,
                    const std::function<float(VoxelIndex)>& value, double voxel_size = 1) {
    bytes.resize(kNodesAt);
    Put(0, uint64_t{0x304244566f6e614e});
    name.copy(bytes.data() + 40, 255);
    for (size_t i = 0; i < 3; ++i) Put(384 + 8 * (4 * i), voxel_size);
    Put(632, uint32_t{2});  // fog volume
    Put(636, uint32_t{1});  // float
    Put(672 + 24, kRootAt - uint64_t{672});
    for (size_t i = 0; i < 3; ++i) {
      Put(kRootAt + 4 * i, first[i]);
      Put(kRootAt + 12 + 4 * i, last[i]);
    }
    for (int x = first[0]; x <= last[0]; ++x) {
      for (int y = first[1]; y <= last[1]; ++y) {
        for (int z = first[2]; z <= last[2]; ++z) PutVoxel({x, y, z}, value({x, y, z}));
      }
    }
  }

  // Places of the root and of the nodes after it, the first of which is an upper one. Its first child mask
  // and table entry.
  static constexpr uint64_t kRootAt = 736, kTilesMax = 8, kNodesAt = kRootAt + 64 + 32 * kTilesMax;

  template <typename T>
  void Put(uint64_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
  }

  std::string bytes;

 private:
  static uint32_t Bits(int v, int from, int count) {
    return static_cast<uint32_t>(v) >> from & ((1u << count) - 1);
  }
  static uint64_t Place(const VoxelIndex& v, int from, int count) {
    return (uint64_t{Bits(v[0], from, count)} << 2 * count) | (Bits(v[1], from, count) << count) |
           Bits(v[2], from, count);
  }
  // The child of a node at `parent` for this voxel, made if it is missing.
  uint64_t Child(uint64_t parent, uint64_t mask_at, uint64_t table_at, uint64_t n, uint64_t size) {
    uint64_t& child = children_[{parent, n}];
    if (child == 0) {
      child = bytes.size();
      bytes.resize(bytes.size() + size);
      bytes[parent + mask_at + n / 8] |= static_cast<char>(1 << n % 8);
      Put(parent + table_at + 8 * n, static_cast<int64_t>(child - parent));
    }
    return child;
  }
  uint64_t Upper(const VoxelIndex& v) {
    const uint64_t key =
        uint64_t{Bits(v[0], 12, 20)} << 42 | uint64_t{Bits(v[1], 12, 20)} << 21 | Bits(v[2], 12, 20);
    uint64_t& upper = uppers_[key];
    if (upper == 0) {
      const uint64_t tile = kRootAt + 64 + 32 * (uppers_.size() - 1);
      upper = bytes.size();
      bytes.resize(bytes.size() + 270400);
      Put(tile, key);
      Put(tile + 8, static_cast<int64_t>(upper - kRootAt));
      Put(kRootAt + 24, static_cast<uint32_t>(uppers_.size()));
    }
    return upper;
  }
  void PutVoxel(const VoxelIndex& v, float value) {
    const uint64_t lower = Child(Upper(v), 4128, 8256, Place(v, 7, 5), 33856);
    const uint64_t leaf = Child(lower, 544, 1088, Place(v, 3, 4), 2144);
    Put(leaf + 96 + 4 * Place(v, 0, 3), value);
  }

  std::map<uint64_t, uint64_t> uppers_;
  std::map<std::pair<uint64_t, uint64_t>, uint64_t> children_;
};

struct NamedGrid {
  std::string name, bytes;
};

// A file of grids, each compressed with zlib if `is_zipped`.
inline std::string NanoVdbFileBytes(const std::vector<NamedGrid>& grids, bool is_zipped) {
  const auto number = [](uint64_t value, int size) {
    std::string text;
    for (int i = 0; i < size; ++i) text += static_cast<char>(value >> (8 * i) & 0xff);
    return text;
  };
  std::string metas, data;
  for (const NamedGrid& grid : grids) {
    std::string packed = grid.bytes;
    if (is_zipped) {
      uLongf size = compressBound(grid.bytes.size());
      packed.resize(size);
      compress(reinterpret_cast<Bytef*>(packed.data()), &size,
               reinterpret_cast<const Bytef*>(grid.bytes.data()), grid.bytes.size());
      packed = number(size, 8) + packed.substr(0, size);
    }
    std::string meta = number(grid.bytes.size(), 8) + number(packed.size(), 8);
    meta.resize(136);
    meta += number(grid.name.size() + 1, 4);
    meta.resize(176);
    metas += meta + grid.name + '\0';
    data += packed;
  }
  const uint64_t version = 32u << 21 | 4u << 10;
  return "NanoVDB0" + number(version, 4) + number(grids.size(), 2) + number(is_zipped ? 1 : 0, 2) + metas +
         data;
}

}  // namespace tessera
