// Pictures in formats other than OpenEXR, made from what an OpenEXR file holds.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/output/picture_format.h"
#include "renderer/film/picture_file.h"

namespace tessera {

// The display window in linear floats, red, green and blue of each pixel, as the formats below show it.
std::vector<float> LinearColors(const LoadedPicture& picture);

// Fails if pictures of this format cannot be encoded here, because the module that encodes them is not
// installed. Called before any work is done.
Result<void> CheckEncoder(PictureFormat format);

// Encodes the display window; pixels outside the data window are black. Shows the channels R, G and B, or the
// first channel as grey if one of them is missing; other channels are left out.
// PNG and JPEG: 8-bit sRGB, tone-mapped: colours up to 0.8 are kept, brighter ones are compressed towards
// white (Khronos PBR Neutral tone mapper, 2024). TIFF and PFM: linear 32-bit floats. Radiance HDR: linear,
// with a shared exponent; negative values and NaN become 0.
// Errors name `path`. Not for kExr.
Result<std::string> EncodeAs(PictureFormat format, const LoadedPicture& picture, const std::string& path);

// A PNG of 8-bit sRGB values, three for each pixel, rows from top to bottom. Errors name `path`.
Result<std::string> EncodePng(int width, int height, const std::vector<uint8_t>& values,
                              const std::string& path);

}  // namespace tessera
