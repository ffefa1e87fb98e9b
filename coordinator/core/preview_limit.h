// How large the picture of a frame that is not finished may be, wherever it is sent.
#pragma once

#include <cstdint>

namespace tessera {

// Values of all channels together: 3840 x 2160 pixels in colour. More are reduced to every second, third, ...
// pixel, so that a preview takes a bounded amount of memory.
constexpr int64_t kPreviewValuesMax = 25'000'000;

}  // namespace tessera
