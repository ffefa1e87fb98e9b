#include "coordinator/web/api/png.h"

#include <zlib.h>

#include "renderer/util/check.h"

namespace tessera {
namespace {

void AppendNumber(std::string& bytes, uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 0xff);
}

void AppendChunk(std::string& bytes, const char* type, const std::string& data) {
  AppendNumber(bytes, static_cast<uint32_t>(data.size()));
  const std::string checked = type + data;
  bytes += checked;
  AppendNumber(bytes, static_cast<uint32_t>(::crc32(0, reinterpret_cast<const Bytef*>(checked.data()),
                                                    static_cast<uInt>(checked.size()))));
}

}  // namespace

std::string EncodePng(int width, int height, const std::vector<uint8_t>& rgb) {
  const size_t row_bytes = static_cast<size_t>(width) * 3;
  TESSERA_CHECK(width > 0 && height > 0 && rgb.size() == row_bytes * static_cast<size_t>(height));
  std::string rows;
  rows.reserve((row_bytes + 1) * static_cast<size_t>(height));
  for (size_t at = 0; at < rgb.size(); at += row_bytes) {
    rows += '\0';  // no filter
    rows.append(reinterpret_cast<const char*>(&rgb[at]), row_bytes);
  }
  uLongf packed_size = ::compressBound(rows.size());
  std::string packed(packed_size, '\0');
  const int result = ::compress2(reinterpret_cast<Bytef*>(packed.data()), &packed_size,
                                 reinterpret_cast<const Bytef*>(rows.data()), rows.size(), 6);
  TESSERA_CHECK(result == Z_OK);
  packed.resize(packed_size);
  std::string header;
  AppendNumber(header, static_cast<uint32_t>(width));
  AppendNumber(header, static_cast<uint32_t>(height));
  header += std::string("\x08\x02\x00\x00\x00", 5);  // 8 bits, RGB, deflate, no interlacing
  std::string bytes = "\x89PNG\r\n\x1a\n";
  AppendChunk(bytes, "IHDR", header);
  AppendChunk(bytes, "IDAT", packed);
  AppendChunk(bytes, "IEND", "");
  return bytes;
}

}  // namespace tessera
