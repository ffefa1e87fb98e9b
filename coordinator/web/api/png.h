// Writes PNG files of 8-bit colours.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tessera {

// `rgb`: three bytes for each pixel, row by row.
std::string EncodePng(int width, int height, const std::vector<uint8_t>& rgb);

}  // namespace tessera
