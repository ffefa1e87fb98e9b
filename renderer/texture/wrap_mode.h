// What an image shows beyond its border.
#pragma once

#include <algorithm>
#include <cstdint>

namespace tessera {

enum class WrapMode : uint8_t { kRepeat, kBlack, kClamp, kOctahedralSphere };

// Maps the coordinates of a texel into an image of width x height. Returns false if the texel is black.
inline bool Remap(int& x, int& y, int width, int height, WrapMode wrap) {
  if (static_cast<unsigned>(x) < static_cast<unsigned>(width) &&
      static_cast<unsigned>(y) < static_cast<unsigned>(height)) {
    return true;
  }
  if (width <= 0 || height <= 0) return false;  // no texels at all
  switch (wrap) {
    case WrapMode::kBlack: return false;
    case WrapMode::kRepeat:
      x = ((x % width) + width) % width;
      y = ((y % height) + height) % height;
      return true;
    case WrapMode::kOctahedralSphere:
      // Leaving an edge of the unfolded octahedron enters the same edge, mirrored about its middle.
      if (x < 0 || x >= width) {
        x = x < 0 ? -x : 2 * width - 1 - x;
        y = height - 1 - y;
      }
      if (y < 0 || y >= height) {
        x = width - 1 - x;
        y = y < 0 ? -y : 2 * height - 1 - y;
      }
      break;
    case WrapMode::kClamp: break;
  }
  x = std::clamp(x, 0, width - 1);
  y = std::clamp(y, 0, height - 1);
  return true;
}

}  // namespace tessera
