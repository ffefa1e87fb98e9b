#include "renderer/image/exr_header.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "renderer/description/source_location.h"
#include "renderer/image/header_reader.h"
#include "renderer/image/image_limits.h"

namespace tessera {
namespace {

constexpr uint32_t kTiled = 0x200, kDeep = 0x800, kMultiPart = 0x1000;  // flags of the version
constexpr uint64_t kOffsetSize = 8;                                     // bytes of each entry of a table

// What the size of the tables of a part depends on.
struct Part {
  int64_t width = 0, height = 0, channels = 0;
  int64_t tile_width = 0, tile_height = 0;  // 0: scan lines
  bool has_known_types = true;              // of its channels; OpenImageIO aborts the process on others
};

// The sizes of values, in bytes, that OpenEXR reads whatever size the file gives, by the names of their types
// (OpenEXR file layout, "attribute data").
constexpr std::pair<std::string_view, size_t> kFixedSizes[] = {
    {"box2f", 16},
    {"box2i", 16},
    {"chromaticities", 32},
    {"compression", 1},
    {"deepImageState", 1},
    {"double", 8},
    {"envmap", 1},
    {"float", 4},
    {"int", 4},
    {"keycode", 28},
    {"lineOrder", 1},
    {"m33d", 72},
    {"m33f", 36},
    {"m44d", 128},
    {"m44f", 64},
    {"rational", 8},
    {"v2d", 16},
    {"tiledesc", 9},
    {"timecode", 8},
    {"v2f", 8},
    {"v2i", 8},
    {"v3d", 24},
    {"v3f", 12},
    {"v3i", 12},
};
constexpr size_t kChannelSize = 16;  // after its name: the type and other numbers

// Whether OpenEXR reads as many bytes of the value as the file says that it has. If not, it would take other
// bytes for the sizes of the next attributes than those that are checked here.
bool HasSizeOfItsType(std::string_view type, std::string_view value) {
  HeaderReader in(value);
  if (type == "chlist") {
    auto name = in.ZeroEnded();
    while (name && !name->empty() && in.Take(kChannelSize)) name = in.ZeroEnded();
    return name && name->empty() && in.position() == value.size();
  }
  if (type == "stringvector") {
    while (in.position() < value.size()) {
      const auto length = in.Little32();
      if (!length || !in.SkipBytes(*length)) return false;
    }
    return true;
  }
  if (type == "preview") {
    constexpr uint64_t kPixelSize = 4;
    const auto width = in.Little32(), height = width ? in.Little32() : std::nullopt;
    return height && uint64_t{*width} * *height == (value.size() - in.position()) / kPixelSize &&
           (value.size() - in.position()) % kPixelSize == 0;
  }
  const auto* const fixed = std::ranges::find(kFixedSizes, type, &std::pair<std::string_view, size_t>::first);
  return fixed == std::end(kFixedSizes) || fixed->second == value.size();
}

// Reads the headers from the front to the back.
class HeaderCheck {
 public:
  HeaderCheck(const std::string& bytes, const std::string& name) : bytes_(bytes), in_(bytes), name_(name) {}

  Result<void> Check() {
    const std::optional<uint32_t> version = in_.SkipBytes(4) ? in_.Little32() : std::nullopt;
    if (!version) return Damaged("unexpected end of file");
    if ((*version & kDeep) != 0) return Deep();
    is_tiled_ = (*version & kTiled) != 0;
    const bool is_multi_part = (*version & kMultiPart) != 0;
    for (int part = 0;; ++part) {
      if (is_multi_part && in_.Rest().starts_with('\0')) return {};  // the end of all headers
      if (part == kExrPartsMax) return Damaged("too many parts");
      if (Result<void> checked = CheckPart(); !checked) return checked;
      if (!is_multi_part) return {};
    }
  }

 private:
  Result<void> CheckPart() {
    Part part;
    while (true) {
      const std::optional<std::string_view> attribute = in_.ZeroEnded();
      if (!attribute) return Damaged("unexpected end of file");
      if (attribute->empty()) break;
      const std::optional<std::string_view> type = in_.ZeroEnded();
      const std::optional<uint32_t> size = type ? in_.Little32() : std::nullopt;
      if (!size) return Damaged("unexpected end of file");
      const std::optional<std::string_view> value = in_.Take(*size);
      if (!value) {
        return Damaged(fmt::format("the attribute \"{}\" has {} bytes, more than the file",
                                   attribute->substr(0, kNameShown), *size));
      }
      if (!HasSizeOfItsType(*type, *value)) {
        return Damaged(fmt::format("the attribute \"{}\" has {} bytes, which is not the size of its type",
                                   attribute->substr(0, kNameShown), *size));
      }
      if (in_.position() > kExrHeaderSizeMax) return Damaged("the header is too large");
      if (*attribute == "type" && value->starts_with("deep")) return Deep();
      Read(*attribute, *value, part);
      if (!part.has_known_types) return Damaged("a channel has an unknown type");
    }
    return CheckSizes(part);
  }

  static void Read(std::string_view attribute, std::string_view value, Part& part) {
    HeaderReader in(value);
    if (attribute == "dataWindow" && value.size() == 16) {
      int64_t corners[4];
      for (int64_t& corner : corners) corner = static_cast<int32_t>(*in.Little32());
      part.width = corners[2] - corners[0] + 1;
      part.height = corners[3] - corners[1] + 1;
    } else if (attribute == "tiles" && value.size() == 9) {
      part.tile_width = *in.Little32();
      part.tile_height = *in.Little32();
    } else if (attribute == "channels") {
      constexpr uint32_t kTypesEnd = 3;  // integers, halves and floats
      for (auto name = in.ZeroEnded(); name && !name->empty(); name = in.ZeroEnded()) {
        ++part.channels;
        const std::optional<std::string_view> channel = in.Take(kChannelSize);
        if (!channel) break;
        part.has_known_types &= *HeaderReader(*channel).Little32() < kTypesEnd;
      }
    }
  }

  Result<void> CheckSizes(const Part& part) {
    constexpr int64_t kHalfSize = 2;
    const Result<void> size =
        CheckImageSize(name_, part.width, part.height, part.channels, kHalfSize, bytes_.size());
    if (!size) return size;
    // A block of scan lines has at most 256 of them (DWAB). The levels of a tiled picture have more tiles
    // yet.
    constexpr int64_t kBlockLinesMax = 256;
    int64_t blocks = part.height / kBlockLinesMax;
    const bool is_tiled = is_tiled_ || part.tile_width != 0 || part.tile_height != 0;
    if (is_tiled) {
      // A tile is decoded whole, even where it reaches beyond the picture.
      const Result<void> tile =
          CheckImageSize(name_, part.tile_width, part.tile_height, part.channels, kHalfSize, bytes_.size());
      if (!tile) return tile;
      blocks = ((part.width + part.tile_width - 1) / part.tile_width) *
               ((part.height + part.tile_height - 1) / part.tile_height);
    }
    if (static_cast<uint64_t>(blocks) > bytes_.size() / kOffsetSize)
      return Damaged(fmt::format("{} bytes cannot hold {} blocks of pixels", bytes_.size(), blocks));
    return {};
  }

  Error Deep() const { return BadInput(name_ + ": deep and volume pictures are not supported"); }
  Error Damaged(const std::string& why) const {
    return BadInput(fmt::format("{}: damaged OpenEXR picture: {}", name_, OneLine(why)));
  }

  static constexpr size_t kNameShown = 40;
  const std::string& bytes_;
  HeaderReader in_;
  const std::string& name_;
  bool is_tiled_ = false;
};

}  // namespace

Result<void> CheckExr(const std::string& bytes, const std::string& name) {
  return HeaderCheck(bytes, name).Check();
}

}  // namespace tessera
