// The structure of OpenEXR files, checked before the library reads them: it allocates what a header
// announces.
#pragma once

#include <string>

#include "renderer/util/result.h"

namespace tessera {

constexpr size_t kExrHeaderSizeMax = size_t{16} << 20;  // bytes of all headers: room for large previews
constexpr int kExrPartsMax = 64;                        // only the first is read

// Whether every attribute of every header lies within the file, the picture has an allowed size, and the
// tables of offsets that its size calls for fit in the file. Deep pictures are refused.
Result<void> CheckExr(const std::string& bytes, const std::string& name);

}  // namespace tessera
