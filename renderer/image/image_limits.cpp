#include "renderer/image/image_limits.h"

#include <algorithm>

#include <fmt/format.h>

namespace tessera {

Result<void> CheckImageSize(const std::string& name, int64_t width, int64_t height, int64_t channels,
                            int64_t bytes_per_value, uint64_t file_bytes) {
  if (width < 1 || height < 1 || channels < 1) {
    return BadInput(fmt::format("{}: damaged picture: its size is {}x{} with {} channels", name, width,
                                height, channels));
  }
  if (width > kImageSideMax || height > kImageSideMax) {
    return BadInput(fmt::format("{}: picture too large: {}x{} pixels, at most {} on a side are read", name,
                                width, height, kImageSideMax));
  }
  if (channels > kImageChannelsMax) {
    return BadInput(
        fmt::format("{}: picture has {} channels, at most {} are read", name, channels, kImageChannelsMax));
  }
  const int64_t bytes = width * height * channels * bytes_per_value;  // at most 2^16 * 2^16 * 2^6 * 2^2
  if (bytes > kImageBytesMax) {
    return BadInput(fmt::format("{}: picture too large: {} bytes when decoded, at most {} are read", name,
                                bytes, kImageBytesMax));
  }
  const int64_t plausible =
      std::max(kImageExpansionFloor, static_cast<int64_t>(file_bytes) * kImageExpansionMax);
  if (bytes > plausible) {
    return BadInput(fmt::format("{}: damaged picture: {} bytes cannot hold {}x{} pixels", name, file_bytes,
                                width, height));
  }
  return {};
}

}  // namespace tessera
