#include "renderer/film/frame_spec.h"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/film/picture_attributes.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

constexpr size_t kNameSizeMax = 255;  // of an attribute: what OpenEXR can write

bool IsName(const std::string& name) {
  return !name.empty() && name.size() <= kNameSizeMax && name.find('\0') == std::string::npos;
}

Result<void> CheckAdaptive(const FrameSpec& spec) {
  if (!(spec.noise_threshold >= 0 && spec.noise_threshold <= kNoiseThresholdMax)) {
    return BadInput(fmt::format("the noise threshold is {}; it must be 0 (none) to {}", spec.noise_threshold,
                                kNoiseThresholdMax));
  }
  if (!spec.IsAdaptive()) return {};
  const ChannelLayout layout = spec.Layout();
  if (layout.colors().empty()) return BadInput("a noise threshold needs a channel R, G or B to look at");
  if (!layout.samples())
    return BadInput(fmt::format("an adaptive frame needs the channel \"{}\"", kSamplesChannel));
  return {};
}

Result<void> CheckAttributes(const std::map<std::string, std::string>& attributes) {
  if (attributes.size() > kAttributesMax) {
    return BadInput(
        fmt::format("a picture has at most {} attributes, not {}", kAttributesMax, attributes.size()));
  }
  for (const auto& [name, value] : attributes) {
    if (!IsName(name)) return BadInput("an attribute's name is empty or too long");
    if (name.size() + value.size() > kAttributeSizeMax) {
      return BadInput(fmt::format("attribute \"{}\" is longer than {} bytes", name, kAttributeSizeMax));
    }
    if (IsReservedAttribute(name)) {
      return BadInput(fmt::format("attribute \"{}\" is reserved by OpenEXR", name));
    }
    if (!IsAttributeValue(name, value))
      return BadInput(fmt::format("attribute \"{}\" has a value that is not of its type", name));
  }
  return {};
}

int64_t CeilDivide(int64_t a, int64_t b) {
  return (a + b - 1) / b;
}

}  // namespace

Result<void> FrameSpec::Check() const {
  if (width < 1 || height < 1 || width > kResolutionMax || height > kResolutionMax) {
    return BadInput(fmt::format("the resolution is {}x{}; each side must be 1 to {} pixels", width, height,
                                kResolutionMax));
  }
  if (crop.x0 < 0 || crop.y0 < 0 || crop.x1 > width || crop.y1 > height || crop.x0 >= crop.x1 ||
      crop.y0 >= crop.y1) {
    return BadInput(fmt::format("the crop [{},{}) x [{},{}) is empty or leaves the picture of {}x{} pixels",
                                crop.x0, crop.x1, crop.y0, crop.y1, width, height));
  }
  if (crop.area() > kFramePixelsMax) {
    return BadInput(
        fmt::format("the crop holds {} pixels, more than the limit of {}", crop.area(), kFramePixelsMax));
  }
  if (samples_per_pixel < 1 || samples_per_pixel > kSamplesPerPixelMax) {
    return BadInput(
        fmt::format("{} samples per pixel; there must be 1 to {}", samples_per_pixel, kSamplesPerPixelMax));
  }
  if (tile_size < 1 || tile_size > kTileSizeMax) {
    return BadInput(fmt::format("the tile size is {}; it must be 1 to {} pixels", tile_size, kTileSizeMax));
  }
  const int64_t tiles = CeilDivide(crop.width(), tile_size) * CeilDivide(crop.height(), tile_size);
  if (tiles > kTileCountMax) {
    return BadInput(fmt::format("tiles of {} pixels cut the frame into {}, more than the limit of {}",
                                tile_size, tiles, kTileCountMax));
  }
  if (cryptomatte_levels < 1 || cryptomatte_levels > kCryptomatteLevelsMax) {
    return BadInput(fmt::format("{} levels of Cryptomatte; there must be 1 to {}", cryptomatte_levels,
                                kCryptomatteLevelsMax));
  }
  if (auto channels_ok = CheckChannels(channels, cryptomatte_levels); !channels_ok) return channels_ok;
  if (auto adaptive_ok = CheckAdaptive(*this); !adaptive_ok) return adaptive_ok;
  return CheckAttributes(attributes);
}

void FrameSpec::SetNoiseThreshold(double threshold) {
  noise_threshold = threshold;
  if (IsAdaptive() && std::ranges::find(channels, kSamplesChannel, &Channel::name) == channels.end())
    AddChannel(channels, SamplesChannel(false));
}

std::vector<PictureChannel> FrameSpec::PictureChannels() const {
  return tessera::PictureChannels(channels, cryptomatte_levels);
}

int FrameSpec::TileCount() const {
  return static_cast<int>(CeilDivide(crop.width(), tile_size) * CeilDivide(crop.height(), tile_size));
}

PixelBounds FrameSpec::TileBounds(int tile) const {
  TESSERA_CHECK(tile >= 0 && tile < TileCount());
  const int columns = static_cast<int>(CeilDivide(crop.width(), tile_size));
  PixelBounds bounds;
  bounds.x0 = crop.x0 + (tile % columns) * tile_size;
  bounds.y0 = crop.y0 + (tile / columns) * tile_size;
  bounds.x1 = std::min(bounds.x0 + tile_size, crop.x1);
  bounds.y1 = std::min(bounds.y0 + tile_size, crop.y1);
  return bounds;
}

}  // namespace tessera
