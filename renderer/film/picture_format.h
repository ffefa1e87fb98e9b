// How the values of a picture are stored in an OpenEXR file.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "renderer/film/frame_spec.h"

namespace tessera {

// The numbers are those of OpenEXR.
enum class ExrCompression : uint32_t {
  kNone = 0,
  kRle = 1,
  kZips = 2,  // each scan line by itself
  kZip = 3,   // 16 scan lines together
  kPiz = 4,
  kPxr24 = 5,
  kB44 = 6,
  kB44a = 7,
  kDwaa = 8,  // 32 scan lines together
  kDwab = 9,  // 256 scan lines together
};

enum class ExrLayout { kScanLines, kTiles };

constexpr int kExrTileSize = 64;  // pixels, of a file in tiles

// A file that says nothing else is as the farm writes it.
struct ExrFormat {
  ExrCompression compression = ExrCompression::kZip;
  bool is_tiled = false;     // in tiles of kExrTileSize, otherwise in scan lines
  bool has_preview = false;  // a small picture in the header, unless the picture is small itself

  bool operator==(const ExrFormat&) const = default;
};

// "none", "rle", ... by number.
std::span<const std::string_view> ExrCompressionNames();
std::string_view NameOf(ExrCompression compression);
std::optional<ExrCompression> ExrCompressionOf(std::string_view name);

// Whether the compression may change values of a channel (ImfCompression.h; ImfDwaCompressor.cpp has the
// names that DWA looks at).
bool MayChange(ExrCompression compression, std::string_view channel, ExrType type);

}  // namespace tessera
