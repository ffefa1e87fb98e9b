#include "client/output/picture_encoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <exception>

#include "renderer/film/display_color.h"
#include "renderer/formats/loader/module_loader.h"

namespace tessera {
namespace {

using image_module::ValueType;

using Rgb = LinearRgb;

// The positions of red, green and blue among the channels.
std::array<size_t, 3> ColorChannels(const std::vector<std::string>& channels) {
  std::array<size_t, 3> places{};
  constexpr const char* kNames[] = {"R", "G", "B"};
  for (size_t i = 0; i < 3; ++i) {
    const auto found = std::ranges::find(channels, kNames[i]);
    if (found == channels.end()) return {0, 0, 0};
    places[i] = static_cast<size_t>(found - channels.begin());
  }
  return places;
}

std::vector<uint8_t> EightBit(const std::vector<float>& rgb) {
  std::vector<uint8_t> bytes(rgb.size());
  for (size_t i = 0; i < rgb.size(); i += 3) {
    const Rgb mapped = ToneMap({rgb[i], rgb[i + 1], rgb[i + 2]});
    for (size_t c = 0; c < 3; ++c) bytes[i + c] = EncodeSrgb(mapped[c]);
  }
  return bytes;
}

// What an RGBE pixel can hold.
void ClampToRadiance(std::vector<float>& rgb) {
  constexpr float kMax = 1.6e38f;  // just below 2^127
  for (float& value : rgb) value = value > 0 ? std::min(value, kMax) : 0;
}

// Rows from bottom to top, little endian (Debevec's format).
std::string EncodePfm(const LoadedPicture& picture, const std::vector<float>& rgb) {
  static_assert(std::endian::native == std::endian::little);
  std::string bytes = fmt::format("PF\n{} {}\n-1.0\n", picture.width, picture.height);
  const size_t row = static_cast<size_t>(picture.width) * 3;
  for (size_t y = static_cast<size_t>(picture.height); y-- > 0;)
    bytes.append(reinterpret_cast<const char*>(&rgb[y * row]), row * sizeof(float));
  return bytes;
}

Result<std::string> EncodeWithLibrary(const image_module::RgbPicture& picture, const std::string& path) {
  auto encoded = image_module::Encode(picture);
  if (!encoded)
    return Failed(fmt::format("{}: cannot encode the picture: {}", path, encoded.error().message));
  return encoded;
}

Result<std::string> Encode(PictureFormat format, const LoadedPicture& picture, const std::string& path) {
  std::vector<float> rgb = LinearColors(picture);
  switch (format) {
    case PictureFormat::kExr: break;
    case PictureFormat::kPng:
    case PictureFormat::kJpeg: {
      const char* const name = format == PictureFormat::kPng ? "png" : "jpg";
      const std::vector<uint8_t> bytes = EightBit(rgb);
      return EncodeWithLibrary({name, picture.width, picture.height, ValueType::kUint8, bytes.data()}, path);
    }
    case PictureFormat::kTiff:
      return EncodeWithLibrary({"tif", picture.width, picture.height, ValueType::kFloat, rgb.data()}, path);
    case PictureFormat::kRadiance:
      ClampToRadiance(rgb);
      return EncodeWithLibrary({"hdr", picture.width, picture.height, ValueType::kFloat, rgb.data()}, path);
    case PictureFormat::kPfm: return EncodePfm(picture, rgb);
  }
  TESSERA_CHECK(false);
  return std::string();
}

}  // namespace

std::vector<float> LinearColors(const LoadedPicture& picture) {
  const std::array<size_t, 3> places = ColorChannels(picture.channels);
  const size_t channels = picture.channels.size();
  const auto width = static_cast<size_t>(picture.width);
  std::vector<float> values(width * static_cast<size_t>(picture.height) * 3, 0);
  const PixelBounds& data = picture.bounds;
  for (int y = std::max(data.y0, 0); y < std::min(data.y1, picture.height); ++y) {
    for (int x = std::max(data.x0, 0); x < std::min(data.x1, picture.width); ++x) {
      const size_t from = static_cast<size_t>(int64_t{y - data.y0} * data.width() + (x - data.x0)) * channels;
      const size_t to = (static_cast<size_t>(y) * width + static_cast<size_t>(x)) * 3;
      for (size_t c = 0; c < 3; ++c) values[to + c] = picture.values[from + places[c]];
    }
  }
  return values;
}

Result<void> CheckEncoder(PictureFormat format) {
  if (format == PictureFormat::kExr || format == PictureFormat::kPfm) return {};
  const auto library = image_module::Load();
  return library ? Result<void>() : library.error();
}

Result<std::string> EncodeAs(PictureFormat format, const LoadedPicture& picture, const std::string& path) {
  try {
    return Encode(format, picture, path);
  } catch (const std::exception& e) {
    return Failed(fmt::format("{}: cannot encode the picture: {}", path, e.what()));
  }
}

Result<std::string> EncodePng(int width, int height, const std::vector<uint8_t>& values,
                              const std::string& path) {
  return EncodeWithLibrary({"png", width, height, ValueType::kUint8, values.data()}, path);
}

}  // namespace tessera
