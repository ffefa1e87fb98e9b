// The pixels of WebP files.
#pragma once

#include <cstdint>
#include <string_view>

namespace tessera::image_module {

// The size of the picture, which the first frame of an animation may not fill.
struct WebpCanvas {
  int width, height;
  int channels;  // 3: red, green and blue; 4: alpha as well
};

// Stores width * height * channels values of the picture, or of the first frame of an animation; what this
// frame leaves out is transparent black. The colours are those of the file, not multiplied by alpha. Returns
// false if the file is damaged or its frame does not lie on the canvas.
bool DecodeWebpFrame(std::string_view file, const WebpCanvas& canvas, uint8_t* values);

}  // namespace tessera::image_module
