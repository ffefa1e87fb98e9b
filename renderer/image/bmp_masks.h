// The masks of BMP files, which name the bits of red, green and blue in a pixel.
#pragma once

#include <optional>
#include <string>

#include "renderer/util/result.h"

namespace tessera {

// The file with its 32-bit pixels in the order blue, green, red, unused, which is the only one that the
// library reads: it ignores their masks. Returns nullopt if the pixels have this order or another size. Fails
// if the masks are not whole bytes. `bytes` has passed CheckBmp.
Result<std::optional<std::string>> WithStandardMasks(const std::string& bytes, const std::string& name);

}  // namespace tessera
