// The random bits that the dimensions of a sample start from.
#pragma once

#include <cstdint>

#include "renderer/util/hash.h"

namespace tessera {

// A hash of seed and pixel, computed anew only when the pixel changes.
class PixelSeed {
 public:
  explicit PixelSeed(uint64_t seed) : seed_(seed) {}

  // Returns whether the pixel changes.
  bool SetPixel(int x, int y) {
    if (x == x_ && y == y_) return false;
    x_ = x;
    y_ = y;
    value_ = Hash(seed_, static_cast<uint32_t>(x), static_cast<uint32_t>(y));
    return true;
  }

  uint64_t value() const { return value_; }
  uint64_t OfDimension(int dimension) const {
    return MixBits(value_ ^ (static_cast<uint64_t>(dimension) + 1) * 0x9e3779b97f4a7c15u);
  }

 private:
  uint64_t seed_;
  int x_ = -1, y_ = -1;
  uint64_t value_ = 0;
};

}  // namespace tessera
