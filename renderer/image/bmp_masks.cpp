#include "renderer/image/bmp_masks.h"

#include <array>
#include <cstdint>

#include <fmt/format.h>

#include "renderer/util/header_reader.h"

namespace tessera {
namespace {

constexpr size_t kPixelSize = 4;  // bytes

// Of the bytes of a pixel, those that hold blue, green and red.
using ByteOrder = std::array<size_t, 3>;
constexpr ByteOrder kStandardOrder{0, 1, 2};

// The value of `size` bytes at a position.
std::optional<uint32_t> ValueAt(const std::string& bytes, size_t at, int size) {
  HeaderReader in(bytes);
  return in.SkipBytes(at) ? in.Little(size) : std::nullopt;
}

// The byte that a mask selects. Returns nullopt if it selects anything else.
std::optional<size_t> ByteOf(uint32_t mask) {
  for (size_t byte = 0; byte < kPixelSize; ++byte) {
    if (mask == uint32_t{0xff} << 8 * byte) return byte;
  }
  return std::nullopt;
}

// Whether the header has masks and the pixels have 32 bits.
bool HasMasksOf32Bits(const std::string& bytes) {
  constexpr size_t kHeaderSizeAt = 14, kBitsAt = 28, kCompressionAt = 30;
  constexpr uint32_t kOldHeaderSize = 12;  // without masks
  constexpr uint32_t kBitFields = 3;
  return ValueAt(bytes, kHeaderSizeAt, 4) != kOldHeaderSize && ValueAt(bytes, kBitsAt, 2) == 32u &&
         ValueAt(bytes, kCompressionAt, 4) == kBitFields;
}

void Reorder(std::string& bytes, size_t first_pixel, const ByteOrder& order) {
  for (size_t at = first_pixel; at + kPixelSize <= bytes.size(); at += kPixelSize) {
    const std::array<char, kPixelSize> pixel{bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]};
    for (size_t i = 0; i < order.size(); ++i) bytes[at + i] = pixel[order[i]];
  }
}

}  // namespace

Result<std::optional<std::string>> WithStandardMasks(const std::string& bytes, const std::string& name) {
  constexpr size_t kFirstPixelAt = 10, kMasksAt = 54;  // red, green and blue, in all versions of the header
  if (!HasMasksOf32Bits(bytes)) return std::optional<std::string>();
  const auto first_pixel = ValueAt(bytes, kFirstPixelAt, 4);
  ByteOrder order;
  for (size_t i = 0; i < order.size(); ++i) {
    const auto mask = ValueAt(bytes, kMasksAt + 4 * (order.size() - 1 - i), 4);
    if (!mask) return BadInput(fmt::format("{}: damaged BMP picture: unexpected end of file", name));
    const auto byte = ByteOf(*mask);
    if (!byte) {
      return BadInput(
          fmt::format("{}: 32-bit BMP pictures whose masks are not whole bytes are not supported", name));
    }
    order[i] = *byte;
  }
  if (order == kStandardOrder) return std::optional<std::string>();
  std::string reordered = bytes;
  Reorder(reordered, *first_pixel, order);
  return std::optional(std::move(reordered));
}

}  // namespace tessera
