// Tables for whole pictures of 8-bit values.
#pragma once

#include <array>

#include "renderer/image/image.h"

namespace tessera {

// The linear value of each 8-bit one.
std::array<float, 256> DecodingTable(const ColorEncoding& encoding);

}  // namespace tessera
