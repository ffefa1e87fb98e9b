// An image at successively halved resolutions, for lookups whose footprint covers many texels (Williams 1983;
// Heckbert 1989 for the elliptical filter). Immutable.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "renderer/image/image.h"
#include "renderer/math/float4.h"
#include "renderer/math/vec.h"
#include "renderer/texture/wrap_mode.h"

namespace tessera {

enum class ImageFilter : uint8_t { kPoint, kBilinear, kTrilinear, kEwa };

struct ImageFilterSettings {
  ImageFilter filter = ImageFilter::kBilinear;
  float anisotropy_max = 8;  // of kEwa: longest over shortest axis of the ellipse
};

class MipMap {
 public:
  // One channel of the image, by its index, or three. An image whose sides are not powers of two is first
  // resampled to the next larger ones. Values keep the format of the image; those that are not finite become
  // finite.
  static MipMap Grey(const Image& image, int channel, WrapMode wrap);
  static MipMap Color(const Image& image, std::array<int, 3> channels, WrapMode wrap);
  // One channel that holds the mean of three, in at least half precision.
  static MipMap GreyOfColor(const Image& image, std::array<int, 3> channels, WrapMode wrap);

  int channels() const { return channels_; }
  int levels() const { return static_cast<int>(levels_.size()); }
  int width() const { return levels_[0].width; }
  int height() const { return levels_[0].height; }
  size_t bytes() const { return texels_.size(); }
  // Those of the image.
  const std::optional<Chromaticities>& chromaticities() const { return chromaticities_; }
  // A value as stored; x and y must be inside the level. For tests.
  float Texel(int level, int x, int y, int channel) const;

  // The filtered value at st, where (0, 0) is the upper left corner of the image and (1, 1) the lower right
  // one. dst0 and dst1 span the footprint. Any argument is allowed, finite or not.
  float LookUpGrey(Point2 st, Vec2 dst0, Vec2 dst1,
                   const ImageFilterSettings& settings) const;  // of one channel
  Float4 LookUpColor(Point2 st, Vec2 dst0, Vec2 dst1,
                     const ImageFilterSettings& settings) const;  // of three: r g b *

 private:
  friend class MipMapMaker;
  template <PixelFormat kFormat, int kChannels>
  friend class MipMapReader;
  struct Level {
    size_t offset = 0;  // bytes
    int width = 0, height = 0;
  };

  MipMap() = default;

  PixelFormat format_ = PixelFormat::kFloat;
  WrapMode wrap_ = WrapMode::kRepeat;
  int channels_ = 1;
  std::vector<Level> levels_;
  std::vector<uint8_t> texels_;  // of all levels, with room for one load of 16 bytes after the last
  std::optional<Chromaticities> chromaticities_;
  std::array<float, 256> decoded_{};  // of kUint8: the linear values
};

}  // namespace tessera
