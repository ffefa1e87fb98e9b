// Which pixels of a tile samples are wanted of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

// Pixels of a rectangle by their index y * width + x. Made without arguments it has all, whatever the size.
class PixelMask {
 public:
  PixelMask() = default;
  // The pixels i with `chosen[i]`.
  static PixelMask Of(const std::vector<bool>& chosen);
  // What Bytes gave, for a rectangle of `pixels`. Refuses another length, bits beyond the last pixel, and a
  // mask without any pixel.
  static Result<PixelMask> Read(std::string_view bytes, size_t pixels);

  bool operator==(const PixelMask&) const = default;
  bool HasAll() const { return bits_.empty(); }
  bool Has(size_t pixel) const {
    return bits_.empty() || (static_cast<unsigned char>(bits_[pixel / 8]) >> pixel % 8 & 1) != 0;
  }
  // How many of `pixels`, the size of the rectangle.
  size_t Count(size_t pixels) const;
  // One bit for each pixel, the lowest first; nothing if it has all.
  const std::string& Bytes() const { return bits_; }

 private:
  std::string bits_;  // empty: all
};

}  // namespace tessera
