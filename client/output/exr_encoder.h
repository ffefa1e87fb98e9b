// OpenEXR files made from pictures that were read and changed.
#pragma once

#include <string>

#include "renderer/film/picture_file.h"

namespace tessera {

// Encodes all channels: the colours of the layers `RGB` and `noisy` with the precision `type`, others as
// 32-bit floats. Attributes are kept. Errors name `path`.
Result<std::string> EncodeLoaded(const LoadedPicture& picture, ExrType type, const std::string& path);

}  // namespace tessera
