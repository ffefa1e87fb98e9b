#include "renderer/film/picture_preview.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tessera {
namespace {

// IEC 61966-2-1; not finite values are black.
unsigned char ToSrgb(float linear) {
  const float x = std::isfinite(linear) ? std::clamp(linear, 0.0f, 1.0f) : 0.0f;
  const float encoded = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
  return static_cast<unsigned char>(std::lround(encoded * 255));
}

// The first of the pixels that pixel `i` of `size` stands for.
int First(int i, int size, int full) {
  return static_cast<int>(int64_t{i} * full / size);
}

}  // namespace

std::optional<Imf::PreviewImage> MakePreviewImage(const PixelBounds& bounds,
                                                  std::span<const std::string> channels,
                                                  std::span<const float> values) {
  std::array<size_t, 3> rgb{};
  for (size_t c = 0; c < 3; ++c) {
    rgb[c] = static_cast<size_t>(std::ranges::find(channels, std::string(1, "RGB"[c])) - channels.begin());
    if (rgb[c] == channels.size()) return std::nullopt;
  }
  const int longer = std::max(bounds.width(), bounds.height());
  if (longer <= kPreviewSizeMax) return std::nullopt;
  const int width = std::max(1, static_cast<int>(int64_t{bounds.width()} * kPreviewSizeMax / longer));
  const int height = std::max(1, static_cast<int>(int64_t{bounds.height()} * kPreviewSizeMax / longer));
  Imf::PreviewImage preview(static_cast<unsigned>(width), static_cast<unsigned>(height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int x0 = First(x, width, bounds.width()), x1 = First(x + 1, width, bounds.width());
      const int y0 = First(y, height, bounds.height()), y1 = First(y + 1, height, bounds.height());
      std::array<float, 3> sum{};
      for (int row = y0; row < y1; ++row) {
        for (int column = x0; column < x1; ++column) {
          const size_t pixel =
              static_cast<size_t>(row) * static_cast<size_t>(bounds.width()) + static_cast<size_t>(column);
          for (size_t c = 0; c < 3; ++c) sum[c] += values[pixel * channels.size() + rgb[c]];
        }
      }
      const float share = 1 / static_cast<float>((x1 - x0) * (y1 - y0));
      preview.pixel(static_cast<unsigned>(x), static_cast<unsigned>(y)) = {
          ToSrgb(sum[0] * share), ToSrgb(sum[1] * share), ToSrgb(sum[2] * share), 255};
    }
  }
  return preview;
}

}  // namespace tessera
