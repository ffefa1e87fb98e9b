#include "renderer/material/normal_map.h"

#include <cmath>

namespace tessera {
namespace {

// One axis of a bilinear lookup: two texels and the weight of the second.
struct Axis {
  int low, high;
  float weight;
};

Axis RepeatedAxis(float coordinate, int size) {
  // In [0, 1], so that large coordinates stay representable.
  const float wrapped = coordinate - std::floor(coordinate);
  const float x = wrapped * static_cast<float>(size) - 0.5f;
  const float low = std::floor(x);
  const int i = static_cast<int>(low);
  return {(i + size) % size, (i + 1) % size, x - low};
}

}  // namespace

Vec3 NormalMap::Lookup(Point2 uv) const {
  if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return {0, 0, 1};
  const Axis x = RepeatedAxis(uv.x, image_->width), y = RepeatedAxis(1 - uv.y, image_->height);
  Vec3 n;
  for (int c = 0; c < 3; ++c) {
    const int channel = channels_[c];
    const float top = Lerp(x.weight, image_->Get(x.low, y.low, channel), image_->Get(x.high, y.low, channel));
    const float bottom =
        Lerp(x.weight, image_->Get(x.low, y.high, channel), image_->Get(x.high, y.high, channel));
    n[c] = 2 * Lerp(y.weight, top, bottom) - 1;
  }
  const float length = Length(n);
  return length > 0 && std::isfinite(length) ? n / length : Vec3{0, 0, 1};
}

}  // namespace tessera
