// Pictures as PNG, for viewing.
#pragma once

#include <string>

#include "renderer/film/picture_file.h"

namespace tessera {

// Encodes the display window as an 8-bit sRGB PNG: colours up to 0.8 are kept, brighter ones are compressed
// towards white (Khronos PBR Neutral tone mapper, 2024); pixels outside the data window are black. Shows the
// channels R, G and B, or the first channel as grey if one of them is missing. Errors name `path`.
Result<std::string> EncodePng(const LoadedPicture& picture, const std::string& path);

}  // namespace tessera
