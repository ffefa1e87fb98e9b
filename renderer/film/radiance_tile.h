// The sums of one work unit: what a worker returns.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "film/frame_spec.h"
#include "util/digest.h"

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

// Bytes of a tile: "TSRT", version, bounds, range, channel count, then the sums, all little-endian, then the
// first 8 bytes of the SHA-256 of all before. One codec for the wire, the spool and the tests.
std::string EncodeRadianceTile(const RadianceTile& tile);
// Refuses a wrong size, version, check sum, a range that is not dyadic, and sums that are not finite.
Result<RadianceTile> DecodeRadianceTile(std::string_view bytes);

// Of the encoded bytes: two renderings of a unit must have the same.
Digest RadianceTileDigest(const RadianceTile& tile);

}  // namespace tessera
