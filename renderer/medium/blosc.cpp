#include "renderer/medium/blosc.h"

#include <algorithm>

#include "renderer/util/header_reader.h"

namespace tessera {
namespace {

// The layout is that of Blosc 1 (README_HEADER.rst of c-blosc).
constexpr uint8_t kShuffled = 0x1, kCopied = 0x2, kBitShuffled = 0x4, kNotSplit = 0x10;  // flags
constexpr int kCodecShift = 5, kLz4Codec = 1;
constexpr size_t kSplitsMax = 16, kSplitSizeMin = 128;

struct BloscHeader {
  uint8_t flags = 0;
  size_t type_size = 0, size = 0, block_size = 0;
};

std::optional<BloscHeader> ReadBloscHeader(HeaderReader& in) {
  const auto versions = in.Little(2), flags = versions ? in.Little(1) : std::nullopt;
  const auto type_size = flags ? in.Little(1) : std::nullopt, size = type_size ? in.Little32() : std::nullopt;
  const auto block_size = size ? in.Little32() : std::nullopt;
  if (!block_size || !in.Little32()) return std::nullopt;  // the packed size, which is known
  return BloscHeader{static_cast<uint8_t>(*flags), *type_size, *size, *block_size};
}

// The first bytes of all values, then the second ones, and so on, back in the order of the values.
std::string Unshuffled(std::string_view bytes, size_t type_size) {
  std::string values(bytes);
  const size_t count = bytes.size() / type_size;
  for (size_t byte = 0; byte < type_size; ++byte) {
    for (size_t i = 0; i < count; ++i) values[i * type_size + byte] = bytes[byte * count + i];
  }
  return values;
}

// Parts of equal size, each either compressed or, if that did not help, as it is.
std::optional<std::string> UnpackBlock(HeaderReader in, size_t size, size_t parts) {
  std::string block;
  block.reserve(size);
  for (size_t part = 0; part < parts; ++part) {
    const auto packed_size = in.Little32();
    const auto packed = packed_size ? in.Take(*packed_size) : std::nullopt;
    if (!packed) return std::nullopt;
    const size_t end = block.size() + size / parts;
    if (packed->size() == size / parts) {
      block += *packed;
    } else if (!UnpackLz4(*packed, end, block)) {
      return std::nullopt;
    }
  }
  if (block.size() != size) return std::nullopt;
  return block;
}

// Lengths of 15 and more go on in further bytes.
bool ReadLz4Length(HeaderReader& in, size_t& length) {
  constexpr size_t kMore = 15;
  constexpr uint32_t kMoreByte = 255;
  if (length != kMore) return true;
  for (;;) {
    const std::optional<uint32_t> byte = in.Little(1);
    if (!byte) return false;
    length += *byte;
    if (*byte != kMoreByte) return true;
  }
}

}  // namespace

// Sequences of literals and of copies of what was unpacked before (lz4_Block_format.md).
bool UnpackLz4(std::string_view packed, size_t size, std::string& out) {
  constexpr size_t kCopyMin = 4;
  const size_t start = out.size();
  HeaderReader in(packed);
  while (const std::optional<uint32_t> token = in.Little(1)) {
    size_t literals = *token >> 4, copy = *token & 0xf;
    if (!ReadLz4Length(in, literals) || literals > size - out.size()) return false;
    const std::optional<std::string_view> text = in.Take(literals);
    if (!text) return false;
    out += *text;
    if (in.Rest().empty()) break;  // the last sequence copies nothing
    const std::optional<uint32_t> offset = in.Little(2);
    if (!offset || *offset == 0 || *offset > out.size() - start || !ReadLz4Length(in, copy)) return false;
    copy += kCopyMin;
    if (copy > size - out.size()) return false;
    for (size_t from = out.size() - *offset; copy > 0; --copy, ++from) out += out[from];
  }
  return out.size() == size;
}

std::optional<std::string> UnpackBlosc(std::string_view packed, size_t size) {
  HeaderReader in(packed);
  const std::optional<BloscHeader> header = ReadBloscHeader(in);
  if (!header || header->size != size) return std::nullopt;
  if ((header->flags & kCopied) != 0) {
    const std::optional<std::string_view> bytes = in.Take(size);
    return bytes ? std::optional(std::string(*bytes)) : std::nullopt;
  }
  if (header->flags >> kCodecShift != kLz4Codec || (header->flags & kBitShuffled) != 0) return std::nullopt;
  const size_t type_size = header->type_size, block_size = header->block_size;
  if (type_size == 0 || block_size == 0) return std::nullopt;
  std::string unpacked;
  unpacked.reserve(size);
  while (unpacked.size() < size) {
    const std::optional<uint32_t> start = in.Little32();
    if (!start || *start > packed.size()) return std::nullopt;
    const size_t length = std::min(block_size, size - unpacked.size());
    const bool is_split = (header->flags & kNotSplit) == 0 && type_size <= kSplitsMax &&
                          block_size / type_size >= kSplitSizeMin && length == block_size;
    const auto block = UnpackBlock(HeaderReader(packed.substr(*start)), length, is_split ? type_size : 1);
    if (!block) return std::nullopt;
    unpacked += (header->flags & kShuffled) != 0 ? Unshuffled(*block, type_size) : *block;
  }
  return unpacked;
}

}  // namespace tessera
