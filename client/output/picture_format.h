// The formats that pictures are written in, chosen by the endings of file names.
#pragma once

#include <string>

#include "renderer/util/result.h"

namespace tessera {

enum class PictureFormat { kExr, kPng, kJpeg, kTiff, kRadiance, kPfm };

// The format of a file of this name: .exr .png .jpg .jpeg .tif .tiff .hdr .pfm in any case, or OpenEXR if the
// name has no ending, as those of devices. Any other ending is bad input.
Result<PictureFormat> PictureFormatOf(const std::string& path);

// Fails if a picture of this size does not fit the format.
Result<void> CheckFormatSize(const std::string& path, int width, int height);

}  // namespace tessera
