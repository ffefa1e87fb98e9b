// A picture for the eye.
#pragma once

#include <string>

#include "renderer/film/picture_file.h"

namespace tessera {

// The bytes of an 8-bit sRGB PNG of the display window: colours up to 0.8 as they are, brighter ones
// compressed towards white (Khronos PBR Neutral tone mapper, 2024); black outside the data window. Shows R,
// G, B, or else the first channel as grey. An error names `path`.
Result<std::string> EncodePng(const LoadedPicture& picture, const std::string& path);

}  // namespace tessera
