#include "renderer/image/container_check.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <zlib.h>

#include "renderer/util/header_reader.h"

namespace tessera {
namespace {

constexpr size_t kSignatureSize = 8;
constexpr size_t kChunkOverhead = 12;    // length, type and checksum
constexpr size_t kHeaderChunkSize = 13;  // of IHDR
constexpr uint32_t kChunkSizeMax = 1u << 31;

uint32_t BigEndian(std::string_view bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<uint8_t>(bytes[at + i]);
  return value;
}

bool IsValidDepth(int color_type, int depth) {
  switch (color_type) {
    case 0: return depth == 1 || depth == 2 || depth == 4 || depth == 8 || depth == 16;
    case 3: return depth == 1 || depth == 2 || depth == 4 || depth == 8;
    case 2:
    case 4:
    case 6: return depth == 8 || depth == 16;
    default: return false;
  }
}

// One that a reader must know, or one it may skip: four letters, the first of them lower case.
bool IsKnownChunk(std::string_view type) {
  if (type == "IHDR" || type == "PLTE" || type == "IDAT") return true;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return std::all_of(type.begin(), type.end(), is_letter) && type[0] >= 'a';
}

Error Damaged(const std::string& name, std::string_view format, std::string_view why) {
  return BadInput(fmt::format("{}: damaged {} picture: {}", name, format, why));
}

}  // namespace

Result<void> CheckPng(const std::string& bytes, const std::string& name) {
  const auto damaged = [&name](std::string_view why) { return Damaged(name, "PNG", why); };
  const std::string_view all = bytes;
  size_t at = kSignatureSize;
  bool is_first = true, has_data = false;
  while (true) {
    if (all.size() < at + kChunkOverhead) return damaged("unexpected end of file");
    const uint32_t length = BigEndian(all, at);
    if (length > kChunkSizeMax || all.size() - at - kChunkOverhead < length)
      return damaged("unexpected end of file");
    const std::string_view type_and_data = all.substr(at + 4, length + 4);
    const std::string_view type = type_and_data.substr(0, 4), data = type_and_data.substr(4);
    const uint32_t checksum = static_cast<uint32_t>(crc32(
        0, reinterpret_cast<const Bytef*>(type_and_data.data()), static_cast<uInt>(type_and_data.size())));
    if (checksum != BigEndian(all, at + 8 + length)) return damaged("wrong checksum");
    if (is_first != (type == "IHDR")) return damaged("no header at the start");
    if (is_first) {
      if (length != kHeaderChunkSize || !IsValidDepth(data[9], data[8])) return damaged("wrong header");
      is_first = false;
    }
    if (type == "IDAT") has_data = true;
    if (type == "IEND") return has_data ? Result<void>() : Result<void>(damaged("it holds no pixels"));
    if (!IsKnownChunk(type)) return damaged("unknown kind of chunk");
    at += kChunkOverhead + length;
  }
}

Result<void> CheckBmp(const std::string& bytes, const std::string& name) {
  constexpr size_t kCompressionAt = 30;
  constexpr uint32_t kNone = 0, kBitFields = 3;
  constexpr uint32_t kOldHeaderSize = 12;  // without compression
  HeaderReader header(bytes);
  const auto header_size = header.SkipBytes(14) ? header.Little32() : std::nullopt;
  if (!header_size) return Damaged(name, "BMP", "unexpected end of file");
  if (*header_size == kOldHeaderSize) return {};
  HeaderReader in(bytes);
  const auto compression = in.SkipBytes(kCompressionAt) ? in.Little32() : std::nullopt;
  if (!compression) return Damaged(name, "BMP", "unexpected end of file");
  if (*compression == kNone || *compression == kBitFields) return {};
  return BadInput(fmt::format("{}: compressed BMP pictures are not supported", name));
}

Result<void> CheckJpeg(const std::string& bytes, const std::string& name) {
  const std::string_view all = bytes;
  size_t at = 2;  // after the start mark
  while (at + 4 <= all.size() && static_cast<uint8_t>(all[at]) == 0xff) {
    const uint8_t marker = static_cast<uint8_t>(all[at + 1]);
    if (marker == 0xff) {  // a fill byte
      ++at;
      continue;
    }
    // In the pixels themselves every byte ff is followed by 0, so this can only be the end mark.
    constexpr uint8_t kStartOfScan = 0xda;
    if (marker == kStartOfScan) {
      if (all.find("\xff\xd9", at) != std::string_view::npos) return {};
      return Damaged(name, "JPEG", "unexpected end of file");
    }
    at += 2 + (static_cast<uint8_t>(all[at + 2]) << 8 | static_cast<uint8_t>(all[at + 3]));
  }
  return Damaged(name, "JPEG", "it holds no pixels");
}

}  // namespace tessera
