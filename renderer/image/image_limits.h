// How large a picture may be. Files are untrusted: every size is checked before memory is allocated.
#pragma once

#include <cstdint>
#include <string>

#include "renderer/util/result.h"

namespace tessera {

constexpr int64_t kImageSideMax = 65536;              // pixels: twice the largest texture we have met
constexpr int64_t kImageChannelsMax = 64;             // more than any beauty picture with its layers
constexpr int64_t kImageBytesMax = int64_t{1} << 31;  // decoded: a 16k x 8k float environment map fits
constexpr int64_t kImageExpansionMax = 10000;         // decoded bytes per file byte: deflate reaches 1032
constexpr int64_t kImageExpansionFloor = int64_t{1} << 24;  // bytes decoded from any file, however small
// All pictures of a scene together: decoded bytes per byte of their files, and bytes allowed whatever the
// files.
constexpr int64_t kImagesExpansionMax = 200;
constexpr int64_t kImagesBytesFloor = int64_t{4} << 30;

// Whether a picture of this size may be decoded from a file of `file_bytes`; the error names the limit
// that it exceeds.
Result<void> CheckImageSize(const std::string& name, int64_t width, int64_t height, int64_t channels,
                            int64_t bytes_per_value, uint64_t file_bytes);

}  // namespace tessera
