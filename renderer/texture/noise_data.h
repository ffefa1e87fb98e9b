// Perlin's permutation of 0 ... 255 (2002).
#pragma once

#include <array>
#include <cstdint>

namespace tessera {

extern const std::array<uint8_t, 256> kNoisePermutation;

}  // namespace tessera
