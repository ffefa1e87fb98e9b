// tessera info of a picture: what the header of an OpenEXR file says.
#pragma once

#include <string>

#include "renderer/util/result.h"

namespace tessera {

// Whether the file is an OpenEXR file, by its first bytes. False if it cannot be read.
bool IsPictureFile(const std::string& path);

Result<void> PrintPictureInfo(const std::string& path, bool json);

}  // namespace tessera
