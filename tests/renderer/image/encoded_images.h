// Pictures in memory, written by the library that reads them or byte by byte, and decoded again.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "renderer/image/image.h"

namespace tessera {

// A file of OpenImageIO's format `plugin`; `values` are width * height * channels of them.
template <typename T>
std::string Encode(const std::string& plugin, int width, int height, int channels,
                   const std::vector<T>& values) {
  OIIO::TypeDesc type = OIIO::TypeDesc::UINT8;
  if (sizeof(T) == 2) type = OIIO::TypeDesc::UINT16;
  if (sizeof(T) == 4) type = OIIO::TypeDesc::FLOAT;
  OIIO::ImageSpec spec(width, height, channels, type);
  if (channels == 2 || channels == 4) spec.attribute("oiio:UnassociatedAlpha", 1);
  if (plugin == "jpeg") spec.attribute("Compression", "jpeg:100");
  std::vector<unsigned char> file;
  OIIO::Filesystem::IOVecOutput proxy(file);
  auto output = OIIO::ImageOutput::create(plugin);
  if (!output || !output->set_ioproxy(&proxy)) return "";
  if (!output->open("memory." + plugin, spec)) return "";
  if (!output->write_image(type, values.data())) return "";
  output->close();
  return {file.begin(), file.end()};
}

// A picture in which every value is different from its neighbours, and no two channels are alike.
inline std::vector<uint8_t> Pattern8(int width, int height, int channels) {
  std::vector<uint8_t> values(static_cast<size_t>(width) * height * channels);
  for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<uint8_t>(i * 37 + i / 7 * 11);
  return values;
}

inline std::vector<float> PatternFloat(int width, int height, int channels) {
  std::vector<float> values(static_cast<size_t>(width) * height * channels);
  for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i % 29) * 0.25f + 0.5f;
  return values;
}

inline std::string BigEndian32(uint32_t v) {
  return {static_cast<char>(v >> 24), static_cast<char>(v >> 16), static_cast<char>(v >> 8),
          static_cast<char>(v)};
}

// A portable float map of one or three channels, rows from the top in `values`.
inline std::string EncodePfm(int width, int height, int channels, const std::vector<float>& values) {
  std::string file = std::string(channels == 3 ? "PF" : "Pf") + "\n" + std::to_string(width) + " " +
                     std::to_string(height) + "\n-1.0\n";
  const size_t row = static_cast<size_t>(width) * channels;
  for (int y = height - 1; y >= 0; --y) {
    file.append(reinterpret_cast<const char*>(&values[y * row]), row * sizeof(float));
  }
  return file;
}

// The picture of a file that must be readable.
inline Image Decoded(const std::string& bytes, const std::string& name,
                     std::optional<ColorEncoding> encoding = {}) {
  Result<Image> image = DecodeImage(bytes, name, encoding);
  if (!image) {
    ADD_FAILURE() << image.error().message;
    return {};
  }
  return std::move(image).value();
}

inline std::string ErrorOf(const std::string& bytes, const std::string& name) {
  const Result<Image> image = DecodeImage(bytes, name, {});
  return image ? "no error" : image.error().message;
}

}  // namespace tessera
