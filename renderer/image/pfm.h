// Portable float maps.
#pragma once

#include "renderer/image/image.h"

namespace tessera {

// "PF" (RGB) or "Pf" (grey, channel "Y"), of either byte order; rows come bottom first in the file. Values
// are multiplied by the size of the header's scale, as pbrt does.
Result<Image> DecodePfm(const std::string& bytes, const std::string& name);

}  // namespace tessera
