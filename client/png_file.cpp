#include "client/png_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>

namespace tessera {
namespace {

using Rgb = std::array<float, 3>;

// Khronos PBR Neutral tone mapper (Khronos Group, 2024), without its Fresnel compensation of dark colours: it
// keeps hue and, below `start`, every value, and lets highlights fade to white.
Rgb ToneMap(Rgb color) {
  constexpr float kStart = 0.8f;
  constexpr float kDesaturation = 0.15f;
  for (float& value : color) value = std::isfinite(value) ? std::max(value, 0.0f) : 0.0f;
  const float peak = std::max({color[0], color[1], color[2]});
  if (peak < kStart) return color;
  constexpr float kRoom = 1 - kStart;
  const float new_peak = 1 - kRoom * kRoom / (peak + kRoom - kStart);
  const float fade = 1 - 1 / (kDesaturation * (peak - new_peak) + 1);
  for (float& value : color) value = std::lerp(value * (new_peak / peak), new_peak, fade);
  return color;
}

// IEC 61966-2-1.
uint8_t EncodeSrgb(float linear) {
  const float encoded = linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
  return static_cast<uint8_t>(std::lround(std::clamp(encoded, 0.0f, 1.0f) * 255));
}

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

std::vector<uint8_t> EightBit(const LoadedPicture& picture) {
  const std::array<size_t, 3> places = ColorChannels(picture.channels);
  const size_t channels = picture.channels.size();
  std::vector<uint8_t> bytes(static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height) * 3, 0);
  const PixelBounds& data = picture.bounds;
  for (int y = std::max(data.y0, 0); y < std::min(data.y1, picture.height); ++y) {
    for (int x = std::max(data.x0, 0); x < std::min(data.x1, picture.width); ++x) {
      const size_t from = static_cast<size_t>(int64_t{y - data.y0} * data.width() + (x - data.x0)) * channels;
      const Rgb mapped = ToneMap({picture.values[from + places[0]], picture.values[from + places[1]],
                                  picture.values[from + places[2]]});
      const size_t to =
          (static_cast<size_t>(y) * static_cast<size_t>(picture.width) + static_cast<size_t>(x)) * 3;
      for (size_t c = 0; c < 3; ++c) bytes[to + c] = EncodeSrgb(mapped[c]);
    }
  }
  return bytes;
}

Result<std::string> Encode(const LoadedPicture& picture, const std::string& path) {
  std::vector<unsigned char> encoded;
  OIIO::Filesystem::IOVecOutput memory(encoded);
  const auto output = OIIO::ImageOutput::create("memory.png", &memory);
  if (!output) return Failed(fmt::format("{}: cannot encode the PNG: {}", path, OIIO::geterror()));
  OIIO::ImageSpec spec(picture.width, picture.height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  output->set_ioproxy(&memory);
  if (!output->open("memory.png", spec) ||
      !output->write_image(OIIO::TypeDesc::UINT8, EightBit(picture).data()) || !output->close()) {
    return Failed(fmt::format("{}: cannot encode the PNG: {}", path, output->geterror()));
  }
  return std::string(encoded.begin(), encoded.end());
}

}  // namespace

Result<std::string> EncodePng(const LoadedPicture& picture, const std::string& path) {
  try {
    return Encode(picture, path);
  } catch (const std::exception& e) {
    return Failed(fmt::format("{}: cannot encode the PNG: {}", path, e.what()));
  }
}

}  // namespace tessera
