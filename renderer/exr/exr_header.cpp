#include "renderer/exr/exr_header.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "renderer/util/header_reader.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::string_view kMagic = "\x76\x2f\x31\x01";
constexpr uint32_t kTiled = 0x200, kDeep = 0x800, kMultiPart = 0x1000;  // flags of the version
constexpr uint64_t kOffsetSize = 8;                                     // bytes of each entry of a table

// What the size of the tables of a part depends on.
struct Part {
  int64_t width = 0, height = 0, channels = 0;
  int64_t tile_width = 0, tile_height = 0;  // 0: scan lines
  int64_t block_lines = 1;                  // scan lines that are compressed together
  uint64_t chunks = 0;                      // entries of the table of offsets, if the header gives them
  bool has_known_types = true;              // of its channels; OpenImageIO aborts the process on others
  std::string_view subsampled;              // the first channel that has fewer values than pixels
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

// Scan lines that are compressed together, by the number of the compression: none, RLE, ZIPS, ZIP, PIZ,
// PXR24, B44, B44A, DWAA, DWAB.
constexpr int64_t kBlockLines[] = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};

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
  HeaderCheck(std::string_view bytes, const std::string& name, const ExrSizeCheck& check_size)
      : bytes_(bytes), in_(bytes), name_(name), check_size_(check_size) {}

  Result<void> Check() {
    if (in_.Take(4) != kMagic) return BadInput(name_ + ": is not an OpenEXR file");
    const std::optional<uint32_t> version = in_.Little32();
    if (!version) return Damaged("unexpected end of file");
    if ((*version & kDeep) != 0) return Deep();
    is_tiled_ = (*version & kTiled) != 0;
    const bool is_multi_part = (*version & kMultiPart) != 0;
    for (int part = 0;; ++part) {
      if (is_multi_part && in_.Rest().starts_with('\0')) return {};  // the end of all headers
      if (part == kExrPartsMax) return Damaged("too many parts");
      if (Result<void> checked = CheckPart(part == 0); !checked) return checked;
      if (!is_multi_part) return {};
    }
  }

 private:
  Result<void> CheckPart(bool is_first_part) {
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
      if (part.block_lines == 0) return Damaged("the compression is unknown");
    }
    // Only the first part is read.
    if (is_first_part && !part.subsampled.empty()) {
      return BadInput(fmt::format("{}: channel {} is subsampled, which is not supported", name_,
                                  OneLine(part.subsampled.substr(0, kNameShown))));
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
    } else if (attribute == "compression" && value.size() == 1) {
      const auto number = static_cast<uint8_t>(value[0]);
      part.block_lines = number < std::size(kBlockLines) ? kBlockLines[number] : 0;
    } else if (attribute == "chunkCount" && value.size() == 4) {
      part.chunks = *in.Little32();
    } else if (attribute == "channels") {
      constexpr uint32_t kTypesEnd = 3;  // integers, halves and floats
      for (auto name = in.ZeroEnded(); name && !name->empty(); name = in.ZeroEnded()) {
        ++part.channels;
        const std::optional<std::string_view> channel = in.Take(kChannelSize);
        if (!channel) break;
        HeaderReader numbers(*channel);
        part.has_known_types &= *numbers.Little32() < kTypesEnd;
        numbers.SkipBytes(4);  // how it should be compressed
        const auto x_sampling = static_cast<int32_t>(*numbers.Little32());
        const auto y_sampling = static_cast<int32_t>(*numbers.Little32());
        if (part.subsampled.empty() && (x_sampling > 1 || y_sampling > 1)) part.subsampled = *name;
      }
    }
  }

  Result<void> CheckSizes(const Part& part) {
    constexpr int64_t kValueSizeMax = 4;
    if (Result<void> size = check_size_(part.width, part.height, part.channels); !size) return size;
    int64_t block_bytes = part.block_lines * part.channels * kValueSizeMax;
    int64_t blocks = part.height / part.block_lines;
    const bool is_tiled = is_tiled_ || part.tile_width != 0 || part.tile_height != 0;
    if (is_tiled) {
      // A tile is decoded whole, even where it reaches beyond the picture.
      const Result<void> tile = check_size_(part.tile_width, part.tile_height, part.channels);
      if (!tile) return tile;
      block_bytes = part.tile_height * part.channels * kValueSizeMax;
      // The levels of a tiled picture have more tiles yet.
      blocks = ((part.width + part.tile_width - 1) / part.tile_width) *
               ((part.height + part.tile_height - 1) / part.tile_height);
    }
    if ((is_tiled ? part.tile_width : part.width) > kExrBlockBytesMax / block_bytes)
      return Damaged("its pixels are compressed in blocks that are too large");
    blocks_ += std::max(static_cast<uint64_t>(blocks), part.chunks);
    if (blocks_ > bytes_.size() / kOffsetSize)
      return Damaged(fmt::format("{} bytes cannot hold {} blocks of pixels", bytes_.size(), blocks_));
    return {};
  }

  Error Deep() const { return BadInput(name_ + ": deep and volume pictures are not supported"); }
  Error Damaged(const std::string& why) const {
    return BadInput(fmt::format("{}: damaged OpenEXR picture: {}", name_, OneLine(why)));
  }

  static constexpr size_t kNameShown = 40;
  std::string_view bytes_;
  HeaderReader in_;
  const std::string& name_;
  const ExrSizeCheck& check_size_;
  bool is_tiled_ = false;
  uint64_t blocks_ = 0;  // of all parts
};

}  // namespace

Result<void> CheckExr(std::string_view bytes, const std::string& name, const ExrSizeCheck& check_size) {
  return HeaderCheck(bytes, name, check_size).Check();
}

}  // namespace tessera
