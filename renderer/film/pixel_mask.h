// A set of pixels of a tile: those whose samples are wanted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

// Pixels of a rectangle by their index y * width + x. A default-constructed mask has all pixels of any
// rectangle.
class PixelMask {
 public:
  PixelMask() = default;
  // The pixels i with `chosen[i]`.
  static PixelMask Of(const std::vector<bool>& chosen);
  // Reads the result of Bytes for a rectangle of `pixels` pixels. Refuses a wrong length, bits beyond the
  // last pixel and a mask without pixels.
  static Result<PixelMask> Read(std::string_view bytes, size_t pixels);

  bool operator==(const PixelMask&) const = default;
  bool HasAll() const { return bits_.empty(); }
  bool Has(size_t pixel) const {
    return bits_.empty() || (static_cast<unsigned char>(bits_[pixel / 8]) >> pixel % 8 & 1) != 0;
  }
  // The number of pixels in the mask; `pixels` is the size of the rectangle.
  size_t Count(size_t pixels) const;
  // One bit per pixel, the lowest first. Empty if the mask has all pixels.
  const std::string& Bytes() const { return bits_; }

 private:
  std::string bits_;  // empty: all
};

}  // namespace tessera
