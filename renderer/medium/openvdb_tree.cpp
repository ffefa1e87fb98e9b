#include "renderer/medium/openvdb_tree.h"

#include <immintrin.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <optional>

#include "renderer/medium/blosc.h"
#include "renderer/util/load_budget.h"

namespace tessera {
namespace {

// The nodes between root and leaves, from above, and the leaves.
constexpr int kUpperSideBits = 5, kUpperChildBits = 7, kLowerSideBits = 4, kLowerChildBits = 3;
constexpr int64_t kRootTileSide = 4096;
constexpr size_t kLeafVoxels = 512;
constexpr const char* kTruncated = "unexpected end of file, or values that cannot be unpacked";

enum Compression : uint32_t { kZip = 1, kActiveMask = 2, kBlosc = 4 };
// What is stored of values that are not active.
enum Inactive : uint64_t {
  kBackground = 0,
  kMinusBackground = 1,
  kOneValue = 2,
  kMaskOfBackground = 3,
  kMaskAndOneValue = 4,
  kMaskAndTwoValues = 5,
  kAllValues = 6,
};

bool IsBitOn(std::string_view mask, size_t n) {
  return (static_cast<uint8_t>(mask[n / 8]) >> (n % 8) & 1) != 0;
}

size_t CountOn(std::string_view mask) {
  size_t count = 0;
  for (const char byte : mask) count += static_cast<size_t>(std::popcount(static_cast<uint8_t>(byte)));
  return count;
}

// The place of child or voxel n of a node along each axis.
VdbOrigin PlaceOf(size_t n, int side_bits) {
  const int64_t last = (int64_t{1} << side_bits) - 1;
  const auto place = static_cast<int64_t>(n);
  return {place >> (2 * side_bits), place >> side_bits & last, place & last};
}

std::optional<std::string> Inflate(std::string_view packed, size_t size) {
  std::string unpacked(size, '\0');
  uLongf length = size;
  const int status = uncompress(reinterpret_cast<Bytef*>(unpacked.data()), &length,
                                reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  if (status != Z_OK || length != size) return std::nullopt;
  return unpacked;
}

}  // namespace

std::string OpenVdbTree::ReadTopology() {
  in_.Unsigned32();  // the number of buffers: 1
  background_ = in_.Float();
  const uint32_t tiles = in_.Unsigned32(), children = in_.Unsigned32();
  const auto read_origin = [this] {
    VdbOrigin origin{};
    for (int64_t& coordinate : origin) coordinate = in_.Signed32();
    return origin;
  };
  for (uint32_t i = 0; i < tiles && !in_.failed(); ++i) {
    const VdbOrigin origin = read_origin();
    const float value = in_.Float();
    AddTile(origin, kRootTileSide, value, in_.Integer(1) != 0);
  }
  for (uint32_t i = 0; i < children && !in_.failed(); ++i) {
    const VdbOrigin origin = read_origin();
    if (!ReadNode(kUpperSideBits, kUpperChildBits, origin)) return kTruncated;
  }
  return in_.failed() ? kTruncated : "";
}

bool OpenVdbTree::ReadNode(int side_bits, int child_bits, const VdbOrigin& origin) {
  CheckLoadBudget();
  const size_t count = size_t{1} << (3 * side_bits);
  const std::string_view children = in_.Take(count / 8), active = in_.Take(count / 8);
  std::vector<float> values;
  if (in_.failed() || !ReadValues(active, count, values)) return false;
  const int64_t side = int64_t{1} << child_bits;
  for (size_t n = 0; n < count; ++n) {
    const VdbOrigin place = PlaceOf(n, side_bits);
    const VdbOrigin child{origin[0] + place[0] * side, origin[1] + place[1] * side,
                          origin[2] + place[2] * side};
    if (!IsBitOn(children, n)) {
      AddTile(child, side, values[n], IsBitOn(active, n));
    } else if (child_bits == kUpperChildBits) {
      if (!ReadNode(kLowerSideBits, kLowerChildBits, child)) return false;
    } else {
      ReadLeafTopology(child);
    }
  }
  return !in_.failed();
}

void OpenVdbTree::ReadLeafTopology(const VdbOrigin& origin) {
  const std::string_view active = in_.Take(kLeafVoxels / 8);
  if (in_.failed()) return;
  leaves_.push_back({origin, active});
  for (size_t n = 0; n < kLeafVoxels; ++n) {
    if (!IsBitOn(active, n)) continue;
    const VdbOrigin place = PlaceOf(n, kLowerChildBits);
    Include({origin[0] + place[0], origin[1] + place[1], origin[2] + place[2]}, 1);
  }
}

void OpenVdbTree::AddTile(const VdbOrigin& origin, int64_t side, float value, bool is_active) {
  if (is_active) Include(origin, side);
  if (value != 0) tiles_.push_back({origin, side, value});
}

void OpenVdbTree::Include(const VdbOrigin& first, int64_t side) {
  for (size_t i = 0; i < 3; ++i) {
    const int64_t last = std::clamp<int64_t>(first[i] + side - 1, INT32_MIN, INT32_MAX);
    active_box_.min[i] =
        std::min(active_box_.min[i], static_cast<int>(std::clamp<int64_t>(first[i], INT32_MIN, INT32_MAX)));
    active_box_.max[i] = std::max(active_box_.max[i], static_cast<int>(last));
  }
}

bool OpenVdbTree::ReadStored(size_t count, std::vector<float>& values) {
  const size_t value_size = storage_.is_half ? 2 : 4, size = count * value_size;
  values.assign(count, 0);
  if (count == 0 && storage_.is_half) return true;
  std::optional<std::string> bytes;
  if ((storage_.compression & (kBlosc | kZip)) != 0) {
    // A size that is not positive is that of values that are not compressed.
    const auto packed_size = static_cast<int64_t>(in_.Integer(8));
    const bool is_packed = packed_size > 0;
    const std::string_view packed = in_.Take(is_packed ? static_cast<uint64_t>(packed_size)
                                                       : uint64_t{0} - static_cast<uint64_t>(packed_size));
    if (in_.failed()) return false;
    if (!is_packed)
      bytes = std::string(packed);
    else
      bytes = (storage_.compression & kBlosc) != 0 ? UnpackBlosc(packed, size) : Inflate(packed, size);
  } else {
    bytes = std::string(in_.Take(size));
  }
  if (in_.failed() || !bytes || bytes->size() != size) return false;
  VdbCursor in(*bytes);
  for (float& value : values)
    value = storage_.is_half ? _cvtsh_ss(static_cast<uint16_t>(in.Integer(2))) : in.Float();
  return true;
}

bool OpenVdbTree::ReadValues(std::string_view active, size_t count, std::vector<float>& values) {
  const uint64_t kind = in_.Integer(1);
  if (kind > kAllValues) return false;
  float inactive = kind == kBackground ? background_ : -background_, selected = background_;
  if (kind == kOneValue || kind == kMaskAndOneValue || kind == kMaskAndTwoValues) inactive = in_.Float();
  if (kind == kMaskAndTwoValues) selected = in_.Float();
  std::string_view selection;
  if (kind == kMaskOfBackground || kind == kMaskAndOneValue || kind == kMaskAndTwoValues)
    selection = in_.Take(count / 8);
  const bool are_active_alone = (storage_.compression & kActiveMask) != 0 && kind != kAllValues;
  std::vector<float> stored;
  if (in_.failed() || !ReadStored(are_active_alone ? CountOn(active) : count, stored)) return false;
  if (stored.size() == count) {
    values = std::move(stored);
    return true;
  }
  values.resize(count);
  for (size_t n = 0, next = 0; n < count; ++n) {
    const bool is_selected = !selection.empty() && IsBitOn(selection, n);
    values[n] = IsBitOn(active, n) ? stored[next++] : is_selected ? selected : inactive;
  }
  return true;
}

std::string OpenVdbTree::ReadVoxels(bool may_be_negative, VdbGrid* grid) {
  VdbGridFiller filler(*grid, may_be_negative);
  for (const Tile& tile : tiles_) {
    if (!filler.Fill(tile.origin, tile.side, tile.value)) return filler.problem();
  }
  std::vector<float> values;
  for (const Leaf& leaf : leaves_) {
    CheckLoadBudget();
    const std::string_view active = in_.Take(kLeafVoxels / 8);
    if (in_.failed() || !ReadValues(active, kLeafVoxels, values)) return kTruncated;
    for (size_t n = 0; n < kLeafVoxels; ++n) {
      const VdbOrigin place = PlaceOf(n, kLowerChildBits);
      const VdbOrigin voxel{leaf.origin[0] + place[0], leaf.origin[1] + place[1], leaf.origin[2] + place[2]};
      if (!filler.Fill(voxel, 1, values[n])) return filler.problem();
    }
  }
  return "";
}

}  // namespace tessera
