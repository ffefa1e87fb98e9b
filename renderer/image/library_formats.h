// The formats that OpenImageIO reads, through its module (renderer/formats).
#pragma once

#include "renderer/image/image.h"
#include "renderer/image/image_format.h"

namespace tessera {

// `format` is one of EXR, PNG, JPEG, TGA, HDR, TIFF, BMP, WebP. 8-bit values stay 8-bit; 16-bit integers are
// decoded to half; half and float stay. Alpha is not multiplied into the colours. As in pbrt, TGA and BMP
// lose their alpha.
Result<Image> DecodeWithLibrary(ImageFormat format, const std::string& bytes, const std::string& name,
                                std::optional<ColorEncoding> encoding);

}  // namespace tessera
