#include "renderer/image/declared_size.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "renderer/description/number.h"
#include "renderer/image/image_limits.h"
#include "renderer/util/header_reader.h"

namespace tessera {
namespace {

using Size = std::optional<DeclaredSize>;

// Two integers of `bytes` bytes each from `at`.
Size PairAt(std::string_view file, size_t at, int bytes, bool is_little) {
  HeaderReader in(file);
  if (!in.SkipBytes(at)) return std::nullopt;
  const auto width = in.Integer(bytes, is_little), height = in.Integer(bytes, is_little);
  if (!width || !height) return std::nullopt;
  return DeclaredSize{*width, *height};
}

// Of the header chunk, which CheckPng demands at the start.
Size PngSize(std::string_view file) {
  if (file.size() < 16 || file.substr(12, 4) != "IHDR") return std::nullopt;
  return PairAt(file, 16, 4, false);
}

Size TgaSize(std::string_view file) {
  return PairAt(file, 12, 2, true);
}

// Rows from the top have a negative height.
Size BmpSize(std::string_view file) {
  constexpr size_t kHeaderAt = 14;
  constexpr uint32_t kOldHeaderSize = 12;
  HeaderReader in(file);
  const auto header_size = in.SkipBytes(kHeaderAt) ? in.Little32() : std::nullopt;
  if (!header_size) return std::nullopt;
  if (*header_size == kOldHeaderSize) return PairAt(file, kHeaderAt + 4, 2, true);
  Size size = PairAt(file, kHeaderAt + 4, 4, true);
  if (size) size->width = std::abs(int64_t{static_cast<int32_t>(size->width)});
  if (size) size->height = std::abs(int64_t{static_cast<int32_t>(size->height)});
  return size;
}

// The segments up to the first start of a frame.
Size JpegSize(std::string_view file) {
  HeaderReader in(file);
  in.SkipBytes(2);
  while (const auto mark = in.Big(1)) {
    if (*mark != 0xff) return std::nullopt;
    auto kind = in.Big(1);
    while (kind && *kind == 0xff) kind = in.Big(1);  // fill bytes
    const auto length = kind ? in.Big(2) : std::nullopt;
    if (!length || *length < 2) return std::nullopt;
    const bool is_frame = *kind >= 0xc0 && *kind <= 0xcf && *kind != 0xc4 && *kind != 0xc8 && *kind != 0xcc;
    if (is_frame) {
      const Size size = PairAt(in.Rest(), 1, 2, false);
      return size ? Size(DeclaredSize{size->height, size->width}) : size;
    }
    if (!in.SkipBytes(*length - 2)) return std::nullopt;
  }
  return std::nullopt;
}

// An unsigned integer of at most 4 or of 8 bytes.
std::optional<uint64_t> Unsigned(HeaderReader& in, int bytes, bool is_little) {
  if (bytes != 8) return in.Integer(bytes, is_little);
  const auto first = in.Integer(4, is_little), second = in.Integer(4, is_little);
  if (!first || !second) return std::nullopt;
  return is_little ? uint64_t{*second} << 32 | *first : uint64_t{*first} << 32 | *second;
}

// Bytes of a width or height of this type of TIFF, which has 32 bits unless it is one of two types.
int TiffValueSize(uint32_t type) {
  constexpr uint32_t kShort = 3, kLong8 = 16;
  if (type == kShort) return 2;
  return type == kLong8 ? 8 : 4;
}

// Of its first picture. The integers of a BigTIFF are wider.
Size TiffSize(std::string_view file) {
  constexpr uint32_t kWidthTag = 256, kHeightTag = 257;
  constexpr uint32_t kBigTiff = 43;
  const bool is_little = file.starts_with("II");
  HeaderReader in(file);
  const auto version = in.SkipBytes(2) ? in.Integer(2, is_little) : std::nullopt;
  if (!version) return std::nullopt;
  const bool is_big = *version == kBigTiff;
  const int offset_size = is_big ? 8 : 4, count_size = is_big ? 8 : 2;
  if (is_big && !in.SkipBytes(4)) return std::nullopt;  // the size of offsets
  const auto directory = Unsigned(in, offset_size, is_little);
  HeaderReader entries(file);
  if (!directory || !entries.SkipBytes(*directory)) return std::nullopt;
  const auto count = Unsigned(entries, count_size, is_little);
  DeclaredSize size;
  for (uint64_t i = 0; count && i < *count; ++i) {
    const auto tag = entries.Integer(2, is_little), type = entries.Integer(2, is_little);
    const auto values = Unsigned(entries, offset_size, is_little);
    const std::optional<std::string_view> value = entries.Take(static_cast<uint64_t>(offset_size));
    if (!tag || !type || !values || !value) break;
    HeaderReader field(*value);
    const auto number = Unsigned(field, TiffValueSize(*type), is_little);
    if (!number) continue;  // too wide for the field: damaged, and left to the library
    const auto side = static_cast<int64_t>(std::min<uint64_t>(*number, std::numeric_limits<int64_t>::max()));
    if (*tag == kWidthTag) size.width = side;
    if (*tag == kHeightTag) size.height = side;
  }
  return size.width > 0 && size.height > 0 ? Size(size) : std::nullopt;
}

Size WebpSize(std::string_view file) {
  constexpr size_t kChunkAt = 12, kDataAt = 20;
  const std::string_view kind = file.size() > kDataAt ? file.substr(kChunkAt, 4) : std::string_view();
  if (kind == "VP8X") {
    const Size size = PairAt(file, kDataAt + 4, 3, true);
    return size ? Size(DeclaredSize{size->width + 1, size->height + 1}) : size;
  }
  if (kind == "VP8 ") {
    constexpr int64_t kSideMask = 0x3fff;  // the upper bits are a scale
    const Size size = PairAt(file, kDataAt + 6, 2, true);
    return size ? Size(DeclaredSize{size->width & kSideMask, size->height & kSideMask}) : size;
  }
  if (kind == "VP8L") {
    HeaderReader in(file);
    in.SkipBytes(kDataAt + 1);
    const auto bits = in.Little32();
    if (bits) return DeclaredSize{(*bits & 0x3fff) + 1, (*bits >> 14 & 0x3fff) + 1};
  }
  return std::nullopt;
}

// The resolution line after the empty line: "-Y 480 +X 640".
Size HdrSize(std::string_view file) {
  const size_t end_of_header = file.find("\n\n");
  if (end_of_header == std::string_view::npos) return std::nullopt;
  std::string_view line = file.substr(end_of_header + 2);
  line = line.substr(0, line.find('\n'));
  int64_t sides[2] = {};
  for (int64_t& side : sides) {
    line.remove_prefix(std::min(line.find_first_of("XY"), line.size()));
    line.remove_prefix(std::min(line.find_first_of("0123456789"), line.size()));
    ReadNumber(line.data(), line.data() + line.size(), side);
  }
  return DeclaredSize{sides[1], sides[0]};
}

}  // namespace

std::optional<DeclaredSize> FindDeclaredSize(ImageFormat format, std::string_view bytes) {
  switch (format) {
    case ImageFormat::kPng: return PngSize(bytes);
    case ImageFormat::kJpeg: return JpegSize(bytes);
    case ImageFormat::kTga: return TgaSize(bytes);
    case ImageFormat::kHdr: return HdrSize(bytes);
    case ImageFormat::kTiff: return TiffSize(bytes);
    case ImageFormat::kBmp: return BmpSize(bytes);
    case ImageFormat::kWebp: return WebpSize(bytes);
    case ImageFormat::kExr:
    case ImageFormat::kPfm:
    case ImageFormat::kQoi:
    case ImageFormat::kUnknown: break;
  }
  return std::nullopt;
}

Result<void> CheckDeclaredSize(ImageFormat format, const std::string& bytes, const std::string& name) {
  const std::optional<DeclaredSize> size = FindDeclaredSize(format, bytes);
  if (!size) return {};
  return CheckImageSize(name, size->width, size->height, 1, 1, bytes.size());
}

}  // namespace tessera
