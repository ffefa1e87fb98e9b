// The size that the header of a picture announces, read before any library does: libraries allocate it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "renderer/image/image_format.h"
#include "renderer/util/result.h"

namespace tessera {

struct DeclaredSize {
  int64_t width = 0, height = 0;
};

// Of PNG, JPEG, TGA, HDR, TIFF, BMP and WebP files. Returns nullopt where the header announces none: the
// library then finds none either.
std::optional<DeclaredSize> FindDeclaredSize(ImageFormat format, std::string_view bytes);

// Whether a file of this length may hold a picture of the size that it announces.
Result<void> CheckDeclaredSize(ImageFormat format, const std::string& bytes, const std::string& name);

}  // namespace tessera
