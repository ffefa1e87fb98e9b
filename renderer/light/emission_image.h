// Images that lights emit.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/color/color_space.h"
#include "renderer/description/parameter_reader.h"
#include "renderer/image/image.h"

namespace tessera {

// An image with channels R, G and B, all finite, in the colour space that its file names.
class RgbImage {
 public:
  RgbImage() = default;
  // Reads the image that parameter `filename` names. The reader remembers errors; the image is then empty.
  static RgbImage Read(ParameterReader& reader, ImageCache& images, Diagnostics& diagnostics);

  // An image of one value.
  static RgbImage OfOneColor(Rgb rgb);
  // Rows of `width` values from top to bottom.
  static RgbImage OfTexels(const std::vector<Rgb>& texels, int width, const ColorSpace& color_space);

  bool empty() const { return !image_; }
  int width() const { return image_->width; }
  int height() const { return image_->height; }
  const ColorSpace& color_space() const { return *color_space_; }
  // Negative values count as 0, those beyond kEmissionMax as that.
  Rgb At(int x, int y) const;
  // Bilinear interpolation; edge values continue outside. uv is (0, 0) at the first value of the top row.
  Rgb Bilinear(Point2 uv) const;
  Rgb Mean() const { return mean_; }

 private:
  std::shared_ptr<const Image> image_;
  Rgb mean_;
  std::array<int, 3> channels_{};
  const ColorSpace* color_space_ = &ColorSpace::Srgb();
};

// Whether every value of the channel is finite.
bool IsFinite(const Image& image, int channel);

// An image as emitted spectra, one per texel, computed once: a lookup reads one cache line.
class EmissionMap {
 public:
  EmissionMap() = default;
  // `scale` is part of the texels.
  EmissionMap(const RgbImage& image, float scale);

  int width() const { return width_; }
  int height() const { return height_; }
  SampledSpectrum Sample(uint32_t x, uint32_t y, const SampledWavelengths& wavelengths) const;
  // The texel at uv in [0, 1]^2.
  SampledSpectrum SampleNearest(Point2 uv, const SampledWavelengths& wavelengths) const;
  size_t bytes() const { return texels_.size() * sizeof(Texel); }

 private:
  struct alignas(16) Texel {
    SigmoidPolynomial color;
    float scale = 0;
  };

  std::vector<Texel> texels_;
  std::shared_ptr<const DenseTable> white_;
  int width_ = 0, height_ = 0;
};

}  // namespace tessera
