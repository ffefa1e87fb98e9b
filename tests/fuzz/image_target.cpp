#include <zlib.h>

#include "renderer/formats/loader/module_loader.h"
#include "renderer/image/image.h"
#include "renderer/util/check.h"
#include "tests/fuzz/targets.h"

namespace tessera {
namespace {

// Content decides about the format, so another than that of the name may be read.
bool Decode(std::string_view bytes, const std::string& name) {
  const Result<Image> image = DecodeImage(std::string(bytes), name, {});
  if (!image) {
    TESSERA_CHECK(image.error().message.starts_with(name));
    TESSERA_CHECK(image.error().message.find('\n') == std::string::npos);
    return false;
  }
  const size_t value_size = image->format == PixelFormat::kUint8  ? 1
                            : image->format == PixelFormat::kHalf ? 2
                                                                  : 4;
  TESSERA_CHECK(image->width > 0 && image->height > 0 && image->channels > 0);
  const size_t pixels = static_cast<size_t>(image->width) * static_cast<size_t>(image->height);
  TESSERA_CHECK(image->bytes.size() == pixels * static_cast<size_t>(image->channels) * value_size);
  TESSERA_CHECK(image->channel_names.size() == static_cast<size_t>(image->channels));
  for (int c = 0; c < image->channels; ++c) {
    image->Get(0, 0, c);
    image->Get(image->width - 1, image->height - 1, c);
  }
  return true;
}

// A PNG file whose chunks (length, type, data, checksum, all big-endian) have correct checksums.
std::string WithPngChecksums(std::string_view png) {
  constexpr size_t kSignatureSize = 8, kChunkOverhead = 12;
  std::string repaired(png);
  const auto byte = [&](size_t at) { return static_cast<uint32_t>(static_cast<unsigned char>(png[at])); };
  for (size_t at = kSignatureSize; at + kChunkOverhead <= png.size();) {
    const size_t length = byte(at) << 24 | byte(at + 1) << 16 | byte(at + 2) << 8 | byte(at + 3);
    if (length > png.size() - at - kChunkOverhead) break;
    const auto* const data = reinterpret_cast<const unsigned char*>(&png[at + 4]);
    const auto sum = static_cast<uint32_t>(crc32(0, data, static_cast<unsigned>(length) + 4));
    for (size_t i = 0; i < 4; ++i) repaired[at + 8 + length + i] = static_cast<char>(sum >> (24 - 8 * i));
    at += kChunkOverhead + length;
  }
  return repaired;
}

}  // namespace

void PrepareImages() {
  TESSERA_CHECK(image_module::Load().has_value());
}

bool FuzzBmp(std::string_view bytes) {
  return Decode(bytes, "a.bmp");
}
bool FuzzExr(std::string_view bytes) {
  return Decode(bytes, "a.exr");
}
bool FuzzHdr(std::string_view bytes) {
  return Decode(bytes, "a.hdr");
}
bool FuzzJpeg(std::string_view bytes) {
  return Decode(bytes, "a.jpg");
}
bool FuzzPfm(std::string_view bytes) {
  return Decode(bytes, "a.pfm");
}
// Also with the right checksums, which no fuzzer guesses.
bool FuzzPng(std::string_view bytes) {
  const std::string repaired = WithPngChecksums(bytes);
  if (repaired != bytes) Decode(bytes, "a.png");
  return Decode(repaired, "a.png");
}
bool FuzzQoi(std::string_view bytes) {
  return Decode(bytes, "a.qoi");
}
bool FuzzTga(std::string_view bytes) {
  return Decode(bytes, "a.tga");
}
bool FuzzTiff(std::string_view bytes) {
  return Decode(bytes, "a.tif");
}
bool FuzzWebp(std::string_view bytes) {
  return Decode(bytes, "a.webp");
}

}  // namespace tessera
