// Small OpenEXR files, written byte by byte: uncompressed scan lines of 32-bit floats.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tessera {

inline std::string LittleEndian32(uint32_t value) {
  std::string bytes;
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 0xff);
  return bytes;
}
inline std::string FloatBytes(float value) {
  return LittleEndian32(std::bit_cast<uint32_t>(value));
}

inline std::string ExrAttribute(const std::string& name, const std::string& type, const std::string& value) {
  return name + '\0' + type + '\0' + LittleEndian32(static_cast<uint32_t>(value.size())) + value;
}

// The CIE xy of red, green, blue and white.
inline std::string ExrChromaticities(const std::array<float, 8>& xy) {
  std::string value;
  for (const float v : xy) value += FloatBytes(v);
  return ExrAttribute("chromaticities", "chromaticities", value);
}
constexpr std::array<float, 8> kRec709Xy{.64f, .33f, .3f, .6f, .15f, .06f, .3127f, .329f};
constexpr std::array<float, 8> kRec2020Xy{.708f, .292f, .17f, .797f, .131f, .046f, .3127f, .329f};
constexpr std::array<float, 8> kAdobeRgbXy{.64f, .33f, .21f, .71f, .15f, .06f, .3127f, .329f};

inline std::string ExrWindow(uint32_t width, uint32_t height) {
  return LittleEndian32(0) + LittleEndian32(0) + LittleEndian32(width - 1) + LittleEndian32(height - 1);
}

// Everything before the table of offsets, for channels of which each name is one letter.
inline std::string ExrHeader(uint32_t width, uint32_t height, const std::string& channels,
                             const std::string& attributes) {
  std::string list;
  for (const char name : channels) {
    list += std::string{name, '\0'} + LittleEndian32(2) + LittleEndian32(0) + LittleEndian32(1) +
            LittleEndian32(1);
  }
  const std::string window = ExrWindow(width, height);
  return "\x76\x2f\x31\x01" + LittleEndian32(2) + ExrAttribute("channels", "chlist", list + '\0') +
         attributes + ExrAttribute("compression", "compression", std::string(1, '\0')) +
         ExrAttribute("dataWindow", "box2i", window) + ExrAttribute("displayWindow", "box2i", window) +
         ExrAttribute("lineOrder", "lineOrder", std::string(1, '\0')) +
         ExrAttribute("pixelAspectRatio", "float", FloatBytes(1)) +
         ExrAttribute("screenWindowCenter", "v2f", FloatBytes(0) + FloatBytes(0)) +
         ExrAttribute("screenWindowWidth", "float", FloatBytes(1)) + '\0';
}

// `rgb`: R, G and B of each pixel, rows from the top.
inline std::string ExrOf(uint32_t width, uint32_t height, const std::vector<float>& rgb,
                         const std::string& attributes = "") {
  std::string file = ExrHeader(width, height, "BGR", attributes);
  const uint32_t row_bytes = width * 3 * 4, block_bytes = row_bytes + 8;
  const auto first = static_cast<uint32_t>(file.size()) + height * 8;
  for (uint32_t y = 0; y < height; ++y) file += LittleEndian32(first + y * block_bytes) + LittleEndian32(0);
  for (uint32_t y = 0; y < height; ++y) {
    file += LittleEndian32(y) + LittleEndian32(row_bytes);
    for (const uint32_t channel : {2u, 1u, 0u}) {
      for (uint32_t x = 0; x < width; ++x) file += FloatBytes(rgb[(size_t{y} * width + x) * 3 + channel]);
    }
  }
  return file;
}

// A square of one colour.
inline std::string ExrOfOneColor(uint32_t size, float r, float g, float b,
                                 const std::string& attributes = "") {
  std::vector<float> rgb;
  for (uint32_t i = 0; i < size * size; ++i) rgb.insert(rgb.end(), {r, g, b});
  return ExrOf(size, size, rgb, attributes);
}

}  // namespace tessera
