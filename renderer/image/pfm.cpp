#include "renderer/image/pfm.h"

#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "renderer/description/number.h"
#include "renderer/image/image_limits.h"

namespace tessera {
namespace {

static_assert(std::endian::native == std::endian::little);

bool IsSpace(char c) {
  return c == ' ' || c == '\n' || c == '\t' || c == '\r';
}

// The next word of the header; `position` is left just after the white space that ends it.
std::string_view NextWord(std::string_view bytes, size_t& position) {
  const size_t start = position;
  while (position < bytes.size() && !IsSpace(bytes[position])) ++position;
  const std::string_view word = bytes.substr(start, position - start);
  if (position < bytes.size()) ++position;
  return word;
}

template <typename T>
bool Parse(std::string_view word, T& value) {
  const std::optional<T> number = ParseNumber<T>(word);
  if (number) value = *number;
  return number.has_value();
}

struct Header {
  int channels = 0, width = 0, height = 0;
  float scale = 0;
  size_t size = 0;  // bytes
};

bool ReadHeader(std::string_view bytes, Header& header) {
  header.channels = NextWord(bytes, header.size) == "PF" ? 3 : 1;
  return Parse(NextWord(bytes, header.size), header.width) &&
         Parse(NextWord(bytes, header.size), header.height) &&
         Parse(NextWord(bytes, header.size), header.scale) && std::isfinite(header.scale) &&
         header.scale != 0;
}

uint32_t SwapBytes(uint32_t v) {
  return __builtin_bswap32(v);
}

// One row, from file order and scale to ours.
void CopyRow(const char* from, uint8_t* to, size_t values, float scale) {
  for (size_t i = 0; i < values; ++i) {
    uint32_t bits;
    std::memcpy(&bits, from + 4 * i, sizeof bits);
    if (scale > 0) bits = SwapBytes(bits);
    const float value = std::bit_cast<float>(bits) * std::abs(scale);
    std::memcpy(to + 4 * i, &value, sizeof value);
  }
}

}  // namespace

Result<Image> DecodePfm(const std::string& bytes, const std::string& name) {
  Header header;
  if (!ReadHeader(bytes, header)) {
    return BadInput(
        fmt::format("{}: damaged picture: expected \"PF width height scale\" at its start", name));
  }
  const Result<void> size =
      CheckImageSize(name, header.width, header.height, header.channels, 4, bytes.size());
  if (!size) return size.error();
  const size_t row = static_cast<size_t>(header.width) * header.channels;  // values
  if (bytes.size() - header.size < row * header.height * 4) {
    return BadInput(fmt::format("{}: damaged picture: it ends after {} bytes, {} were expected", name,
                                bytes.size(), header.size + row * header.height * 4));
  }
  Image image;
  image.width = header.width;
  image.height = header.height;
  image.channels = header.channels;
  image.format = PixelFormat::kFloat;
  image.channel_names =
      header.channels == 3 ? std::vector<std::string>{"R", "G", "B"} : std::vector<std::string>{"Y"};
  image.bytes.resize(row * header.height * 4);
  for (int y = 0; y < header.height; ++y) {
    const size_t file_row = static_cast<size_t>(header.height - 1 - y);
    CopyRow(bytes.data() + header.size + file_row * row * 4, &image.bytes[y * row * 4], row, header.scale);
  }
  return image;
}

}  // namespace tessera
