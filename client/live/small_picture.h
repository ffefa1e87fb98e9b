// A picture in 8-bit colours, reduced to the size at which it is looked at.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "renderer/film/picture_file.h"

namespace tessera {

struct SmallPicture {
  int width = 0, height = 0;
  std::vector<uint8_t> rgb;  // three for each pixel, rows from top to bottom

  std::array<uint8_t, 3> At(int x, int y) const {
    const size_t at = (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)) * 3;
    return {rgb[at], rgb[at + 1], rgb[at + 2]};
  }
};

// The largest size of the picture's proportions within `width_max` x `height_max`, at least one pixel each
// way. Pictures are not made larger unless `may_grow`.
std::array<int, 2> FittedSize(int width, int height, int width_max, int height_max, bool may_grow);

// The display window at this size, tone-mapped as PNG files are. Each pixel is the mean of those that it
// stands for.
SmallPicture Shrink(const LoadedPicture& picture, int width, int height);

}  // namespace tessera
