// The structure of OpenEXR files, checked before the library reads them: it allocates what a header
// announces, and does not survive every damaged header.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "renderer/util/result.h"

namespace tessera {

constexpr size_t kExrHeaderSizeMax = size_t{16} << 20;  // bytes of all headers: room for large previews
constexpr int kExrPartsMax = 64;                        // only the first is read
// Bytes of the scan lines that are decoded together, for which the library allocates memory even if the
// picture has fewer: 16 channels of a picture 65536 wide in blocks of 256 lines.
constexpr int64_t kExrBlockBytesMax = int64_t{1} << 30;

// Whether the caller reads a picture, or a tile of one, of this size.
using ExrSizeCheck = std::function<Result<void>(int64_t width, int64_t height, int64_t channels)>;

// Whether every attribute of every header lies within the file, `check_size` allows the picture and its
// tiles, and the tables of offsets that its size calls for fit in the file. Deep and subsampled pictures are
// refused.
Result<void> CheckExr(std::string_view bytes, const std::string& name, const ExrSizeCheck& check_size);

}  // namespace tessera
