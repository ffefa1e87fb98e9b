#include "client/live/small_picture.h"

#include <algorithm>
#include <cmath>

#include "client/output/picture_encoder.h"
#include "renderer/film/display_color.h"

namespace tessera {

std::array<int, 2> FittedSize(int width, int height, int width_max, int height_max, bool may_grow) {
  double scale = std::min(static_cast<double>(width_max) / width, static_cast<double>(height_max) / height);
  if (!may_grow) scale = std::min(scale, 1.0);
  const auto fit = [&](int size, int max) {
    return std::clamp(static_cast<int>(std::lround(size * scale)), 1, std::max(max, 1));
  };
  return {fit(width, width_max), fit(height, height_max)};
}

SmallPicture Shrink(const LoadedPicture& picture, int width, int height) {
  const std::vector<float> colors = LinearColors(picture);
  SmallPicture small{width, height, {}};
  small.rgb.reserve(static_cast<size_t>(width) * static_cast<size_t>(height) * 3);
  // Pixels [first, last) of `from` that pixel `i` of `to` stands for.
  const auto pixels = [](int i, int from, int to) {
    const int first = static_cast<int>(int64_t{i} * from / to);
    return std::array{first, std::max(first + 1, static_cast<int>(int64_t{i + 1} * from / to))};
  };
  for (int y = 0; y < height; ++y) {
    const auto [y0, y1] = pixels(y, picture.height, height);
    for (int x = 0; x < width; ++x) {
      const auto [x0, x1] = pixels(x, picture.width, width);
      LinearRgb sum{};
      for (int from_y = y0; from_y < y1; ++from_y) {
        const float* pixel = &colors[(static_cast<size_t>(from_y) * static_cast<size_t>(picture.width) +
                                      static_cast<size_t>(x0)) *
                                     3];
        for (int from_x = x0; from_x < x1; ++from_x, pixel += 3) {
          for (size_t c = 0; c < 3; ++c) sum[c] += pixel[c];
        }
      }
      const auto count = static_cast<float>((y1 - y0) * (x1 - x0));
      const LinearRgb mapped = ToneMap({sum[0] / count, sum[1] / count, sum[2] / count});
      for (const float value : mapped) small.rgb.push_back(EncodeSrgb(value));
    }
  }
  return small;
}

}  // namespace tessera
