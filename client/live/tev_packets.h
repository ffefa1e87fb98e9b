// Messages to the picture viewer tev. Each is a 32-bit length, its own four bytes included, a byte for the
// kind and the members in order: little-endian numbers, one byte for a switch, texts that end with a zero
// byte.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "renderer/film/frame_spec.h"

namespace tessera {

enum class TevPacket : uint8_t {
  kCreateImage = 4,  // whether to bring it to the front, name, width, height, number of channels, their names
  // The same switch, name, number of channels, their names, x, y, width and height of a rectangle, then its
  // floats, one channel after another, rows from top to bottom.
  kUpdateImage = 5,
};

// An image of zeros, which replaces one of the same name.
std::string TevCreateImage(const std::string& name, int width, int height,
                           const std::vector<std::string>& channels);
// `values` has width x height floats for each channel.
std::string TevUpdateImage(const std::string& name, const std::vector<std::string>& channels,
                           const PixelBounds& bounds, std::span<const float> values);

}  // namespace tessera
