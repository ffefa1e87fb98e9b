// Pixels that single rare samples made far brighter than all around.
#pragma once

#include <array>

#include "renderer/denoise/strip.h"

namespace tessera {

constexpr int kFireflyRadius = 2;  // pixels around that are looked at

// Stores for each pixel of row y and for each half the factor, at most 1, that reduces its luminance to what
// is plausible: not much beyond the values of the 24 pixels around in both halves, or of the same pixel in
// the other half.
void FindFireflies(const Strip& strip, int width, int y, std::array<Plane, 2>& factors);

}  // namespace tessera
