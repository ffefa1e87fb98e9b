#include "film/radiance_tile.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "util/check.h"

namespace tessera {
namespace {

static_assert(std::endian::native == std::endian::little, "the codec copies floats as they lie in memory");

constexpr char kMagic[4] = {'T', 'S', 'R', 'T'};
constexpr uint32_t kVersion = 1;
constexpr size_t kCheckSize = 8;

// The bytes before the sums, as they are written.
struct Header {
  char magic[4];
  uint32_t version;
  int32_t x0, y0, x1, y1;
  uint32_t begin, size;
  uint32_t channels;
};
static_assert(sizeof(Header) == 36, "no padding in the format");

// Whether a frame could have such a tile.
Result<void> CheckHeader(const Header& header) {
  const auto inside = [](int32_t v) { return v >= 0 && v <= kResolutionMax; };
  if (!inside(header.x0) || !inside(header.y0) || !inside(header.x1) || !inside(header.y1) ||
      header.x0 >= header.x1 || header.y0 >= header.y1 || header.x1 - header.x0 > kTileSizeMax ||
      header.y1 - header.y0 > kTileSizeMax) {
    return Failed("radiance tile: its bounds are empty or beyond the limits");
  }
  const SampleRange range{header.begin, header.size};
  if (!range.IsDyadic()) {
    return Failed(fmt::format("radiance tile: samples {}+{} are no dyadic range", range.begin, range.size));
  }
  if (header.channels < 1 || header.channels > kChannelsMax) {
    return Failed(
        fmt::format("radiance tile: {} channels; there must be 1 to {}", header.channels, kChannelsMax));
  }
  return {};
}

bool AllFinite(const std::vector<float>& values) {
  for (float value : values) {
    if (!std::isfinite(value)) return false;
  }
  return true;
}

}  // namespace

std::string EncodeRadianceTile(const RadianceTile& tile) {
  TESSERA_CHECK(static_cast<int64_t>(tile.sums.size()) == tile.bounds.area() * tile.channels);
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.version = kVersion;
  header.x0 = tile.bounds.x0;
  header.y0 = tile.bounds.y0;
  header.x1 = tile.bounds.x1;
  header.y1 = tile.bounds.y1;
  header.begin = tile.range.begin;
  header.size = tile.range.size;
  header.channels = static_cast<uint32_t>(tile.channels);
  std::string bytes;
  const size_t sums_size = tile.sums.size() * sizeof(float);
  bytes.reserve(sizeof header + sums_size + kCheckSize);
  bytes.append(reinterpret_cast<const char*>(&header), sizeof header);
  bytes.append(reinterpret_cast<const char*>(tile.sums.data()), sums_size);
  const Digest digest = Sha256(bytes);
  bytes.append(reinterpret_cast<const char*>(digest.bytes.data()), kCheckSize);
  return bytes;
}

Result<RadianceTile> DecodeRadianceTile(std::string_view bytes) {
  if (bytes.size() < sizeof(Header) + kCheckSize) {
    return Failed(fmt::format("radiance tile: cut short at {} bytes", bytes.size()));
  }
  Header header;
  std::memcpy(&header, bytes.data(), sizeof header);
  if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0)
    return Failed("radiance tile: does not begin with TSRT");
  if (header.version != kVersion) {
    return Failed(fmt::format("radiance tile: version {}; this program knows {}", header.version, kVersion));
  }
  const std::string_view body = bytes.substr(0, bytes.size() - kCheckSize);
  if (std::memcmp(Sha256(body).bytes.data(), bytes.data() + body.size(), kCheckSize) != 0) {
    return Failed("radiance tile: its check sum is wrong: it was damaged on its way");
  }
  if (auto ok = CheckHeader(header); !ok) return ok.error();
  RadianceTile tile;
  tile.bounds = {header.x0, header.y0, header.x1, header.y1};
  tile.range = {header.begin, header.size};
  tile.channels = static_cast<int>(header.channels);
  const size_t count = static_cast<size_t>(tile.bounds.area()) * header.channels;
  if (body.size() != sizeof header + count * sizeof(float)) {
    return Failed(fmt::format("radiance tile: {} bytes of sums; its bounds and channels ask for {}",
                              body.size() - sizeof header, count * sizeof(float)));
  }
  tile.sums.resize(count);
  std::memcpy(tile.sums.data(), body.data() + sizeof header, count * sizeof(float));
  if (!AllFinite(tile.sums)) return Failed("radiance tile: it holds a sum that is not finite");
  return tile;
}

Digest RadianceTileDigest(const RadianceTile& tile) {
  return Sha256(EncodeRadianceTile(tile));
}

}  // namespace tessera
