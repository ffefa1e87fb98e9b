#include "coordinator/web/api/color_picture.h"

#include <algorithm>

#include "coordinator/web/api/picture_format.h"
#include "coordinator/web/api/png.h"
#include "renderer/film/display_color.h"

namespace tessera {
namespace {

int Reduced(int size, int step) {
  return (size + step - 1) / step;
}

}  // namespace

int StepFor(const FrameSpec& spec, int size) {
  return Reduced(std::max(spec.crop.width(), spec.crop.height()), size);
}

ColorPicture::ColorPicture(const FrameSpec& spec, int step)
    : width_(Reduced(spec.crop.width(), step)),
      height_(Reduced(spec.crop.height(), step)),
      rgb_(static_cast<size_t>(width_) * static_cast<size_t>(height_) * 3, 0) {}

void ColorPicture::Paint(const FramePicture& tile) {
  const ColorPlaces colors = FindColors(tile.channels);
  const float* values = tile.values.data();
  for (int y = tile.bounds.y0; y < tile.bounds.y1; ++y) {
    for (int x = tile.bounds.x0; x < tile.bounds.x1; ++x, values += tile.channels.size())
      Set(x, y, {values[colors[0]], values[colors[1]], values[colors[2]]});
  }
}

void ColorPicture::Paint(const LoadedPicture& picture, int step) {
  const ColorPlaces colors = FindColors(picture.channels);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const auto row = static_cast<size_t>(y * step) * static_cast<size_t>(picture.bounds.width());
      const float* const values =
          &picture.values[(row + static_cast<size_t>(x * step)) * picture.channels.size()];
      Set(x, y, {values[colors[0]], values[colors[1]], values[colors[2]]});
    }
  }
}

void ColorPicture::Set(int x, int y, const LinearRgb& linear) {
  const LinearRgb shown = ToneMap(linear);
  const size_t place = (static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)) * 3;
  for (size_t c = 0; c < shown.size(); ++c) rgb_[place + c] = EncodeSrgb(shown[c]);
}

std::string ColorPicture::Png() const {
  return EncodePng(width_, height_, rgb_);
}

}  // namespace tessera
