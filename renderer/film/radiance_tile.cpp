#include "renderer/film/radiance_tile.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "renderer/film/pixel_mask.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

static_assert(std::endian::native == std::endian::little, "the codec copies floats as they lie in memory");

constexpr char kMagic[4] = {'T', 'S', 'R', 'T'};
constexpr uint32_t kVersion = 2;
constexpr size_t kCheckSize = 8;

// The bytes before the sums, as they are written.
struct Header {
  char magic[4];
  uint32_t version;
  int32_t x0, y0, x1, y1;
  uint32_t begin, size;
  uint32_t channels;
  uint32_t pixels_held;
};
static_assert(sizeof(Header) == 40, "no padding in the format");

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

// The pixels that have anything but zeros. Most tiles have all: that is found out first, as it is cheap.
PixelMask PixelsHeld(const RadianceTile& tile) {
  const auto channels = static_cast<size_t>(tile.channels);
  const auto is_held = [&](size_t pixel) {
    const float* sums = &tile.sums[pixel * channels];
    return std::any_of(sums, sums + channels, [](float sum) { return std::bit_cast<uint32_t>(sum) != 0; });
  };
  const size_t pixels = tile.sums.size() / channels;
  size_t full = 0;
  while (full < pixels && is_held(full)) ++full;
  if (full == pixels) return {};
  std::vector<bool> held(pixels);
  for (size_t p = 0; p < pixels; ++p) held[p] = is_held(p);
  return PixelMask::Of(held);
}

void AppendBytes(std::string& bytes, const void* from, size_t size) {
  bytes.append(static_cast<const char*>(from), size);
}

// The sums as bytes: a mask unless all pixels are held, then the sums of those held.
Result<std::vector<float>> ReadSums(std::string_view bytes, const Header& header, size_t pixels) {
  const size_t pixel_size = header.channels * sizeof(float);
  const size_t held = header.pixels_held;
  const size_t mask_size = held == pixels ? 0 : (pixels + 7) / 8;
  if (held > pixels || bytes.size() != mask_size + held * pixel_size) {
    return Failed(fmt::format("radiance tile: {} bytes of sums; {} of {} pixels with {} channels need others",
                              bytes.size(), held, pixels, header.channels));
  }
  std::vector<float> sums(pixels * header.channels);
  if (held == 0) return sums;
  if (held == pixels) {
    std::memcpy(sums.data(), bytes.data(), bytes.size());
    return sums;
  }
  const auto mask = PixelMask::Read(bytes.substr(0, mask_size), pixels);
  if (!mask) return Failed("radiance tile: " + mask.error().message);
  if (mask->Count(pixels) != held) return Failed("radiance tile: its mask has another number of pixels");
  const char* from = bytes.data() + mask_size;
  for (size_t p = 0; p < pixels; ++p) {
    if (!mask->Has(p)) continue;
    std::memcpy(&sums[p * header.channels], from, pixel_size);
    from += pixel_size;
  }
  return sums;
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
  const PixelMask held = PixelsHeld(tile);
  const auto pixels = static_cast<size_t>(tile.bounds.area());
  const size_t pixel_size = static_cast<size_t>(tile.channels) * sizeof(float);
  header.pixels_held = static_cast<uint32_t>(held.Count(pixels));
  std::string bytes;
  bytes.reserve(sizeof header + held.Bytes().size() + header.pixels_held * pixel_size + kCheckSize);
  AppendBytes(bytes, &header, sizeof header);
  bytes += held.Bytes();
  if (held.HasAll()) {
    AppendBytes(bytes, tile.sums.data(), pixels * pixel_size);
  } else {
    for (size_t p = 0; p < pixels; ++p) {
      if (held.Has(p)) AppendBytes(bytes, &tile.sums[p * static_cast<size_t>(tile.channels)], pixel_size);
    }
  }
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
  auto sums = ReadSums(body.substr(sizeof header), header, static_cast<size_t>(tile.bounds.area()));
  if (!sums) return sums.error();
  tile.sums = std::move(*sums);
  if (!AllFinite(tile.sums)) return Failed("radiance tile: it holds a sum that is not finite");
  return tile;
}

uint64_t PixelSamples(const RadianceTile& tile) {
  return uint64_t{PixelsHeld(tile).Count(static_cast<size_t>(tile.bounds.area()))} * tile.range.size;
}

Digest RadianceTileDigest(const RadianceTile& tile) {
  return Sha256(EncodeRadianceTile(tile));
}

}  // namespace tessera
