// The sums of one work unit: what a worker returns.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "renderer/film/frame_spec.h"
#include "renderer/util/digest.h"

namespace tessera {

// Sums over the samples of `range` of every channel of every pixel of `bounds`; sums[(y * width + x) *
// channels + c] with x, y from the corner of the bounds. Each pixel's sum is the node `range` of its tree.
struct RadianceTile {
  PixelBounds bounds;
  SampleRange range;
  int channels = 0;
  std::vector<float> sums;

  bool operator==(const RadianceTile&) const = default;
};

// Bytes of a tile: "TSRT", version, bounds, range, channel count, count of pixels held, then, if not all are,
// a mask of those (pixel_mask.h), then the sums of those held, all little-endian, then the first 8 bytes of
// the SHA-256 of all before. Pixels that are not held are zeros: the unit was not asked for them. One codec
// for the wire, the spool and the tests.
std::string EncodeRadianceTile(const RadianceTile& tile);
// Refuses a wrong size, version, check sum, a range that is not dyadic, a mask that does not fit, and sums
// that are not finite.
Result<RadianceTile> DecodeRadianceTile(std::string_view bytes);

// Samples of single pixels that the tile has: of those with anything but zeros.
uint64_t PixelSamples(const RadianceTile& tile);

// Of the encoded bytes: two renderings of a unit must have the same.
Digest RadianceTileDigest(const RadianceTile& tile);

}  // namespace tessera
