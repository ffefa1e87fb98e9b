#include <cstring>
#include <optional>

#include "renderer/film/radiance_tile.h"
#include "renderer/util/check.h"
#include "tests/fuzz/targets.h"

namespace tessera {
namespace {

constexpr size_t kTileHeaderSize = 48;
constexpr uint64_t kTileBytesMax = uint64_t{1} << 20;  // decoded; larger ones only take time

// The request that the tile claims to answer, if a coordinator could have made it.
std::optional<TileRequest> RequestOf(std::string_view tile) {
  if (tile.size() < kTileHeaderSize) return std::nullopt;
  struct {
    char magic[4];
    uint32_t version;
    PixelBounds bounds;
    SampleRange range;
    uint32_t sums, pixels_held, nearest, id_sets;
  } header;
  static_assert(sizeof header == kTileHeaderSize);
  std::memcpy(&header, tile.data(), sizeof header);
  const PixelBounds& bounds = header.bounds;
  const auto is_inside = [](int begin, int end) {
    return begin >= 0 && begin < end && end <= kResolutionMax && end - begin <= kTileSizeMax;
  };
  if (!is_inside(bounds.x0, bounds.x1) || !is_inside(bounds.y0, bounds.y1) || !header.range.IsDyadic())
    return std::nullopt;
  PixelShape shape{header.sums, header.nearest, header.id_sets};
  if (header.version == 2) shape.nearest = shape.id_sets = 0;
  if (shape.sums > kChannelsMax || shape.nearest > kChannelsMax || shape.id_sets > kChannelsMax)
    return std::nullopt;
  if (DecodedSize(bounds, shape, tile.size()) > kTileBytesMax) return std::nullopt;
  return TileRequest{bounds, header.range, shape};
}

// Decodes the tile and checks that it is encoded and decoded to the same values.
bool TryTile(std::string_view bytes, const TileRequest& request) {
  const Result<RadianceTile> tile = DecodeRadianceTile(bytes, request);
  if (!tile) {
    TESSERA_CHECK(!tile.error().message.empty());
    return false;
  }
  TESSERA_CHECK(tile->bounds == request.bounds && tile->range == request.range);
  TESSERA_CHECK(tile->shape == request.shape);
  TESSERA_CHECK(tile->sums.size() * sizeof(float) <= DecodedSize(bytes));
  TESSERA_CHECK(PixelSamples(*tile) <= static_cast<uint64_t>(tile->bounds.area()) * tile->range.size);
  const Result<RadianceTile> again = DecodeRadianceTile(EncodeRadianceTile(*tile), request);
  TESSERA_CHECK(again.has_value() && RadianceTileDigest(*again) == RadianceTileDigest(*tile));
  return true;
}

}  // namespace

// The last 8 bytes of a tile are a checksum that no fuzzer guesses, so the tile is also tried with the right
// one.
bool FuzzRadianceTile(std::string_view bytes) {
  constexpr size_t kChecksumSize = 8;
  TESSERA_CHECK(DecodedSize(bytes) >= bytes.size());
  if (bytes.size() < kChecksumSize) return false;
  const std::optional<TileRequest> request = RequestOf(bytes);
  if (!request) return false;
  const std::string_view body = bytes.substr(0, bytes.size() - kChecksumSize);
  std::string repaired(body);
  const Digest digest = Sha256(body);
  repaired.append(reinterpret_cast<const char*>(digest.bytes.data()), kChecksumSize);
  const bool is_accepted = TryTile(repaired, *request);
  if (bytes != repaired) TESSERA_CHECK(!TryTile(bytes, *request));
  return is_accepted;
}

}  // namespace tessera
