#include "renderer/light/emission_image.h"

#include <cmath>
#include <cstring>

#include "renderer/texture/image_color_space.h"

namespace tessera {

bool IsFinite(const Image& image, int channel) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (!std::isfinite(image.Get(x, y, channel))) return false;
    }
  }
  return true;
}

RgbImage RgbImage::Read(ParameterReader& reader, ImageCache& images, Diagnostics& diagnostics) {
  const std::string name = reader.String("filename", "");
  const Result<std::shared_ptr<const Image>> image = images.Get(name, std::nullopt);
  if (!image) {
    reader.FailAt("filename", image.error().message);
    return {};
  }
  const std::optional<std::array<int, 3>> channels = (*image)->RgbChannels();
  if (!channels) {
    reader.FailAt("filename", "\"" + name + "\" must have channels R, G and B");
    return {};
  }
  const RgbSummary& summary = images.Summary(*image);
  if (!summary.is_finite) {
    reader.FailAt("filename", "\"" + name + "\" contains infinite or NaN values, which a light cannot emit");
    return {};
  }
  RgbImage result;
  result.image_ = *image;
  result.mean_ = summary.mean;
  result.channels_ = *channels;
  result.color_space_ = &ColorSpaceOf((*image)->chromaticities, reader, diagnostics);
  return result;
}

RgbImage RgbImage::OfOneColor(Rgb rgb) {
  return OfTexels({rgb}, 1, ColorSpace::Srgb());
}

RgbImage RgbImage::OfTexels(const std::vector<Rgb>& texels, int width, const ColorSpace& color_space) {
  auto image = std::make_shared<Image>();
  image->width = width;
  image->height = static_cast<int>(texels.size()) / width;
  image->channels = 3;
  image->channel_names = {"R", "G", "B"};
  image->bytes.resize(texels.size() * sizeof(Rgb));
  std::memcpy(image->bytes.data(), texels.data(), image->bytes.size());
  RgbImage result;
  result.mean_ = Summarize(*image).mean;
  result.image_ = std::move(image);
  result.channels_ = {0, 1, 2};
  result.color_space_ = &color_space;
  return result;
}

Rgb RgbImage::At(int x, int y) const {
  const Rgb rgb{image_->Get(x, y, channels_[0]), image_->Get(x, y, channels_[1]),
                image_->Get(x, y, channels_[2])};
  return Min(Rgb{kEmissionMax, kEmissionMax, kEmissionMax}, Max({0, 0, 0}, rgb));
}

Rgb RgbImage::Bilinear(Point2 uv) const {
  const float w = static_cast<float>(width()), h = static_cast<float>(height());
  const float x = std::clamp(uv.x * w - 0.5f, 0.0f, w - 1), y = std::clamp(uv.y * h - 0.5f, 0.0f, h - 1);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, width() - 1), y1 = std::min(y0 + 1, height() - 1);
  const float dx = x - static_cast<float>(x0), dy = y - static_cast<float>(y0);
  return Lerp(dy, Lerp(dx, At(x0, y0), At(x1, y0)), Lerp(dx, At(x0, y1), At(x1, y1)));
}

EmissionMap::EmissionMap(const RgbImage& image, float scale)
    : white_(image.color_space().illuminant()), width_(image.width()), height_(image.height()) {
  texels_.resize(static_cast<size_t>(width_) * height_);
  Texel* texel = texels_.data();
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x, ++texel) {
      const Rgb rgb = image.At(x, y);
      const float range = 2 * MaxComponent(rgb);  // keeps the colour away from the limits of the sigmoid
      texel->color = image.color_space().AlbedoPolynomialFast(range > 0 ? rgb / range : Rgb{});
      texel->scale = range * scale;
    }
  }
}

SampledSpectrum EmissionMap::Sample(uint32_t x, uint32_t y, const SampledWavelengths& wavelengths) const {
  const Texel& texel = texels_[static_cast<size_t>(y) * static_cast<size_t>(width_) + x];
  if (texel.scale == 0) return SampledSpectrum();
  return texel.scale * texel.color.Sample(wavelengths) * SampleTable(*white_, wavelengths);
}

SampledSpectrum EmissionMap::SampleNearest(Point2 uv, const SampledWavelengths& wavelengths) const {
  const int x = std::clamp(static_cast<int>(uv.x * static_cast<float>(width_)), 0, width_ - 1);
  const int y = std::clamp(static_cast<int>(uv.y * static_cast<float>(height_)), 0, height_ - 1);
  return Sample(static_cast<uint32_t>(x), static_cast<uint32_t>(y), wavelengths);
}

}  // namespace tessera
