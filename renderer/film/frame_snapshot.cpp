#include "renderer/film/frame_snapshot.h"

#include <algorithm>

#include "renderer/film/adaptive.h"

namespace tessera {
namespace {

// The sum, in order, of the nodes that make a prefix [0, n) if there is one, of all nodes if there is none.
struct NodeSum {
  std::vector<float> sums;
  uint32_t samples = 0;
};

NodeSum SumOfNodes(const FrameSnapshot::TileNodes& nodes) {
  NodeSum total;
  const bool has_prefix = !nodes.empty() && nodes.front().first.begin == 0;
  for (const auto& [range, sums] : nodes) {
    if (has_prefix && range.begin != total.samples) break;
    total.samples += range.size;
    if (total.sums.empty()) {
      total.sums = *sums;
    } else {
      for (size_t i = 0; i < total.sums.size(); ++i) total.sums[i] = total.sums[i] + (*sums)[i];
    }
  }
  return total;
}

}  // namespace

FramePicture FrameSnapshot::Picture() const {
  FramePicture picture;
  picture.bounds = spec_.crop;
  picture.channels.assign(spec_.channels.begin(),
                          spec_.channels.begin() + static_cast<std::ptrdiff_t>(spec_.MeanCount()));
  picture.samples_min = spec_.samples_per_pixel;
  const size_t pixels = static_cast<size_t>(spec_.crop.area());
  picture.values.assign(pixels * picture.channels.size(), 0.0f);
  if (spec_.samples_aov) picture.samples.assign(pixels, 0.0f);
  for (int tile = 0; tile < spec_.TileCount(); ++tile) Paint(tile, picture);
  return picture;
}

void FrameSnapshot::Paint(int tile, FramePicture& picture) const {
  const NodeSum shown = SumOfNodes(tiles_[static_cast<size_t>(tile)]);
  if (shown.samples == 0) {
    picture.samples_min = 0;
    return;
  }
  const size_t means = spec_.MeanCount();
  const PixelBounds bounds = spec_.TileBounds(tile);
  const float* pixel = shown.sums.data();
  for (int y = bounds.y0; y < bounds.y1; ++y) {
    size_t place = static_cast<size_t>(y - spec_.crop.y0) * static_cast<size_t>(spec_.crop.width()) +
                   static_cast<size_t>(bounds.x0 - spec_.crop.x0);
    float* out = &picture.values[place * means];
    for (int x = bounds.x0; x < bounds.x1; ++x, ++place, pixel += spec_.channels.size()) {
      const float weight = pixel[spec_.channels.size() - 1];
      for (size_t c = 0; c < means; ++c) *out++ = weight != 0 ? pixel[c] / weight : 0.0f;
      const uint32_t samples =
          spec_.IsAdaptive() ? static_cast<uint32_t>(SamplesOf(spec_, pixel)) : shown.samples;
      picture.samples_min = std::min(picture.samples_min, samples);
      if (spec_.samples_aov) picture.samples[place] = static_cast<float>(samples);
    }
  }
}

}  // namespace tessera
