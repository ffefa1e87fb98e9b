// The sums of one work unit: what a worker returns.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "renderer/film/channel_layout.h"
#include "renderer/film/frame_spec.h"
#include "renderer/film/pixel_mask.h"
#include "renderer/util/digest.h"

namespace tessera {

// The samples of `range` of every pixel of `bounds`, row by row, merged over the tree: each pixel's values
// are the node `range` of its tree. The frame's ChannelLayout says which channel is where in `sums`.
struct RadianceTile {
  PixelBounds bounds;
  SampleRange range;
  PixelShape shape;
  std::vector<float> sums;

  bool operator==(const RadianceTile&) const = default;
};

// Bytes of a tile, little-endian:
//   "TSRT"
//   version  2: all channels are sums; 3: there are others
//   bounds (4 x 32 bits), range (2 x 32 bits)
//   shape    version 2: the number of sums; version 3: the numbers of sums, nearest values and sets of ids
//   count of pixels held; if not all are held, a mask of those (pixel_mask.h)
//   the records of those held, then the entries of their sets of ids (channel_layout.h)
//   the first 8 bytes of the SHA-256 of everything before
// Pixels that are not held are zeros: the unit was not asked for them. A tile does not name its channels: it
// answers a unit of a frame whose list of channels both ends have compared before. A version is chosen by
// what the tile holds, so that new kinds of channels leave the bytes of all other tiles as they are.
std::string EncodeRadianceTile(const RadianceTile& tile);
// What the tile of a unit must be.
struct TileRequest {
  PixelBounds bounds;
  SampleRange range;
  PixelShape shape;
};
// Refuses a wrong size, version or checksum, anything else than was requested, a mask that does not fit, and
// values that CheckValues refuses or that are not finite. Takes no more memory than DecodedSize, and none for
// a tile that was not requested.
Result<RadianceTile> DecodeRadianceTile(std::string_view bytes, const TileRequest& request);

// An upper limit for the bytes of the values of a tile that was encoded in `encoded_bytes`.
uint64_t DecodedSize(const PixelBounds& bounds, const PixelShape& shape, uint64_t encoded_bytes);
// The same for an encoded tile. Bytes that are no tile are not decoded, and take only their own size.
uint64_t DecodedSize(std::string_view bytes);

// The number of pixel samples in the tile: those of pixels with anything but zeros.
uint64_t PixelSamples(const RadianceTile& tile);

// Sets all pixels that the mask does not have to zero.
void KeepPixels(const PixelMask& kept, RadianceTile& tile);

// Of the values alone, bit for bit: two renderings of a unit must agree. Facts keep it, so it never changes.
Digest RadianceTileDigest(const RadianceTile& tile);

}  // namespace tessera
