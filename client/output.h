// Where pictures go.
#pragma once

#include <string>
#include <string_view>

#include "renderer/util/result.h"

namespace tessera {

// Whether `path` could be written: its folder is there and it is not a folder itself. Said before any work is
// done.
Result<void> CheckWritable(const std::string& path);

// Writes a finished OpenEXR file, and if `png` is not empty what it shows as a PNG there.
Result<void> WritePicture(std::string_view exr, const std::string& path, const std::string& png);

}  // namespace tessera
