#include "renderer/film/radiance_tile.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>

#include "renderer/film/merge_rules.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

static_assert(std::endian::native == std::endian::little, "the codec copies floats as they lie in memory");

constexpr char kMagic[4] = {'T', 'S', 'R', 'T'};
constexpr uint32_t kSumsVersion = 2;   // all channels are sums
constexpr uint32_t kRulesVersion = 3;  // channels of every rule
constexpr size_t kCheckSize = 8;

// The bytes before the values, as they are written; of version 2 without the last two numbers of the shape.
struct Header {
  char magic[4];
  uint32_t version;
  int32_t x0, y0, x1, y1;
  uint32_t begin, size;
  uint32_t sums;
  uint32_t pixels_held;
  uint32_t nearest, id_sets;
};
static_assert(sizeof(Header) == 48, "no padding in the format");
constexpr size_t kSumsHeaderSize = offsetof(Header, nearest);

size_t HeaderSize(uint32_t version) {
  return version == kSumsVersion ? kSumsHeaderSize : sizeof(Header);
}

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
    return Failed(
        fmt::format("radiance tile: samples {}+{} are not a dyadic range", range.begin, range.size));
  }
  const auto channels = uint64_t{header.sums} + header.nearest + header.id_sets;
  if (header.sums < 1 || channels > kChannelsMax) {
    return Failed(fmt::format("radiance tile: {} channels; there must be 1 to {}", channels, kChannelsMax));
  }
  if (header.version == kRulesVersion && header.nearest + header.id_sets == 0)
    return Failed("radiance tile: version 3 without channels that need it");
  return {};
}

// The header of a tile and its size in the bytes.
Result<Header> ReadHeader(std::string_view bytes) {
  Header header{};
  if (bytes.size() < kSumsHeaderSize)
    return Failed(fmt::format("radiance tile: truncated at {} bytes", bytes.size()));
  std::memcpy(&header, bytes.data(), kSumsHeaderSize);
  if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0)
    return Failed("radiance tile: does not start with TSRT");
  if (header.version != kSumsVersion && header.version != kRulesVersion) {
    return Failed(fmt::format("radiance tile: version {}; this program knows {} and {}", header.version,
                              kSumsVersion, kRulesVersion));
  }
  if (header.version == kRulesVersion) {
    if (bytes.size() < sizeof header) return Failed("radiance tile: cut short in its header");
    std::memcpy(&header, bytes.data(), sizeof header);
  }
  return header;
}

// Whether it is the tile that was requested.
Result<void> CheckRequest(const Header& header, const TileRequest& request) {
  const PixelBounds bounds{header.x0, header.y0, header.x1, header.y1};
  const SampleRange range{header.begin, header.size};
  const PixelShape shape{header.sums, header.nearest, header.id_sets};
  if (bounds != request.bounds) return Failed("radiance tile: does not have the bounds of its tile");
  if (range != request.range) {
    return Failed(
        fmt::format("radiance tile: has samples {}, expected {}", range.Text(), request.range.Text()));
  }
  if (shape != request.shape) {
    return Failed(
        fmt::format("radiance tile: has {} channels, expected {}", shape.stride(), request.shape.stride()));
  }
  return {};
}

// The pixels that have anything but zeros. Most tiles have all: that is found out first, as it is cheap.
PixelMask PixelsHeld(const RadianceTile& tile) {
  const size_t stride = tile.shape.stride();
  const auto is_held = [&](size_t pixel) {
    const float* values = &tile.sums[pixel * stride];
    return std::any_of(values, values + stride,
                       [](float value) { return std::bit_cast<uint32_t>(value) != 0; });
  };
  const auto pixels = static_cast<size_t>(tile.bounds.area());
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

// The values as bytes: a mask unless all pixels are held, the records of those held, all entries.
Result<std::vector<float>> ReadValues(std::string_view bytes, const Header& header, const PixelShape& shape,
                                      size_t pixels) {
  const size_t record_bytes = shape.stride() * sizeof(float);
  const size_t held = header.pixels_held;
  const size_t mask_bytes = held == pixels ? 0 : (pixels + 7) / 8;
  const size_t fixed_bytes = mask_bytes + held * record_bytes;
  const bool fits = shape.id_sets == 0
                        ? bytes.size() == fixed_bytes
                        : bytes.size() >= fixed_bytes && (bytes.size() - fixed_bytes) % sizeof(float) == 0;
  if (held > pixels || !fits) {
    return Failed(fmt::format("radiance tile: {} bytes of values; {} of {} pixels with {} channels need {}",
                              bytes.size(), held, pixels, shape.stride(), fixed_bytes));
  }
  std::vector<float> values(pixels * shape.stride() + (bytes.size() - fixed_bytes) / sizeof(float));
  if (held == pixels) {
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
  if (held > 0) {
    const auto mask = PixelMask::Read(bytes.substr(0, mask_bytes), pixels);
    if (!mask) return Failed("radiance tile: " + mask.error().message);
    if (mask->Count(pixels) != held) return Failed("radiance tile: its mask has another number of pixels");
    const char* from = bytes.data() + mask_bytes;
    for (size_t p = 0; p < pixels; ++p) {
      if (!mask->Has(p)) continue;
      std::memcpy(&values[p * shape.stride()], from, record_bytes);
      from += record_bytes;
    }
  }
  std::memcpy(values.data() + pixels * shape.stride(), bytes.data() + fixed_bytes,
              bytes.size() - fixed_bytes);
  return values;
}

// The records of the pixels held, then all entries.
void AppendValues(const RadianceTile& tile, const PixelMask& held, std::string& bytes) {
  if (held.HasAll()) {
    AppendBytes(bytes, tile.sums.data(), tile.sums.size() * sizeof(float));
    return;
  }
  const size_t stride = tile.shape.stride();
  const auto pixels = static_cast<size_t>(tile.bounds.area());
  for (size_t p = 0; p < pixels; ++p) {
    if (held.Has(p)) AppendBytes(bytes, &tile.sums[p * stride], stride * sizeof(float));
  }
  AppendBytes(bytes, tile.sums.data() + pixels * stride,
              (tile.sums.size() - pixels * stride) * sizeof(float));
}

}  // namespace

std::string EncodeRadianceTile(const RadianceTile& tile) {
  const auto pixels = static_cast<size_t>(tile.bounds.area());
  const PixelShape& shape = tile.shape;
  TESSERA_CHECK(shape.HasOnlySums() ? tile.sums.size() == pixels * shape.stride()
                                    : tile.sums.size() >= pixels * shape.stride());
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.version = shape.HasOnlySums() ? kSumsVersion : kRulesVersion;
  header.x0 = tile.bounds.x0;
  header.y0 = tile.bounds.y0;
  header.x1 = tile.bounds.x1;
  header.y1 = tile.bounds.y1;
  header.begin = tile.range.begin;
  header.size = tile.range.size;
  header.sums = shape.sums;
  header.nearest = shape.nearest;
  header.id_sets = shape.id_sets;
  const PixelMask held = PixelsHeld(tile);
  header.pixels_held = static_cast<uint32_t>(held.Count(pixels));
  const size_t values = tile.sums.size() - (pixels - header.pixels_held) * shape.stride();
  std::string bytes;
  bytes.reserve(sizeof header + held.Bytes().size() + values * sizeof(float) + kCheckSize);
  AppendBytes(bytes, &header, HeaderSize(header.version));
  bytes += held.Bytes();
  AppendValues(tile, held, bytes);
  const Digest digest = Sha256(bytes);
  bytes.append(reinterpret_cast<const char*>(digest.bytes.data()), kCheckSize);
  return bytes;
}

Result<RadianceTile> DecodeRadianceTile(std::string_view bytes, const TileRequest& request) {
  if (bytes.size() < kSumsHeaderSize + kCheckSize) {
    return Failed(fmt::format("radiance tile: truncated at {} bytes", bytes.size()));
  }
  const std::string_view body = bytes.substr(0, bytes.size() - kCheckSize);
  const auto header = ReadHeader(body);
  if (!header) return header.error();
  if (std::memcmp(Sha256(body).bytes.data(), bytes.data() + body.size(), kCheckSize) != 0) {
    return Failed("radiance tile: checksum mismatch: the bytes were corrupted in transit");
  }
  if (auto ok = CheckHeader(*header); !ok) return ok.error();
  if (auto ok = CheckRequest(*header, request); !ok) return ok.error();
  RadianceTile tile;
  tile.bounds = {header->x0, header->y0, header->x1, header->y1};
  tile.range = {header->begin, header->size};
  tile.shape = {header->sums, header->nearest, header->id_sets};
  const auto pixels = static_cast<size_t>(tile.bounds.area());
  auto values = ReadValues(body.substr(HeaderSize(header->version)), *header, tile.shape, pixels);
  if (!values) return values.error();
  tile.sums = std::move(*values);
  if (!AreInRange(tile.shape, pixels, tile.sums, tile.range.size))
    return Failed("radiance tile: it holds a value that is not finite or too large");
  if (auto ok = CheckValues(tile.shape, pixels, tile.sums); !ok)
    return Failed("radiance tile: " + ok.error().message);
  return tile;
}

uint64_t DecodedSize(const PixelBounds& bounds, const PixelShape& shape, uint64_t encoded_bytes) {
  return static_cast<uint64_t>(bounds.area()) * shape.stride() * sizeof(float) + encoded_bytes;
}

uint64_t DecodedSize(std::string_view bytes) {
  const auto header = ReadHeader(bytes);
  if (!header || !CheckHeader(*header)) return bytes.size();
  return DecodedSize({header->x0, header->y0, header->x1, header->y1},
                     {header->sums, header->nearest, header->id_sets}, bytes.size());
}

uint64_t PixelSamples(const RadianceTile& tile) {
  return uint64_t{PixelsHeld(tile).Count(static_cast<size_t>(tile.bounds.area()))} * tile.range.size;
}

void KeepPixels(const PixelMask& kept, RadianceTile& tile) {
  KeepPixels(tile.shape, static_cast<size_t>(tile.bounds.area()), kept, tile.sums);
}

Digest RadianceTileDigest(const RadianceTile& tile) {
  return Sha256({reinterpret_cast<const char*>(tile.sums.data()), tile.sums.size() * sizeof(float)});
}

}  // namespace tessera
