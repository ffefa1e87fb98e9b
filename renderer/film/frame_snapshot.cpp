#include "renderer/film/frame_snapshot.h"

#include <algorithm>

#include "renderer/film/merge_rules.h"
#include "renderer/film/tile_painter.h"

namespace tessera {
namespace {

// The nodes that make a prefix [0, n) if there is one, otherwise all nodes, merged in order.
struct NodeSum {
  std::vector<float> values;
  uint32_t samples = 0;
};

NodeSum SumOfNodes(const PixelShape& shape, size_t pixels, const FrameSnapshot::TileNodes& nodes) {
  NodeSum total;
  const bool has_prefix = !nodes.empty() && nodes.front().first.begin == 0;
  for (const auto& [range, values] : nodes) {
    if (has_prefix && range.begin != total.samples) break;
    total.samples += range.size;
    if (total.values.empty()) {
      total.values = *values;
    } else {
      MergeSiblings(shape, pixels, total.values, *values, total.values);
    }
  }
  return total;
}

}  // namespace

std::vector<float> FramePicture::Channel(const std::string& name) const {
  const auto found = std::ranges::find(channels, name);
  std::vector<float> plane;
  if (found == channels.end()) return plane;
  for (auto i = static_cast<size_t>(found - channels.begin()); i < values.size(); i += channels.size())
    plane.push_back(values[i]);
  return plane;
}

FramePicture FrameSnapshot::Picture() const {
  const ChannelLayout layout = spec_.Layout();
  const TilePainter painter(spec_.channels, layout);
  FramePicture picture;
  picture.bounds = spec_.crop;
  picture.channels = painter.Names();
  picture.samples_min = spec_.samples_per_pixel;
  picture.values.assign(static_cast<size_t>(spec_.crop.area()) * picture.channels.size(), 0.0f);
  for (int tile = 0; tile < spec_.TileCount(); ++tile) Paint(tile, painter, picture);
  return picture;
}

void FrameSnapshot::Paint(int tile, const TilePainter& painter, FramePicture& picture) const {
  const PixelBounds bounds = spec_.TileBounds(tile);
  const auto pixels = static_cast<size_t>(bounds.area());
  const ChannelLayout& layout = painter.layout();
  const NodeSum shown = SumOfNodes(layout.shape(), pixels, tiles_[static_cast<size_t>(tile)]);
  if (shown.samples == 0) {
    picture.samples_min = 0;
    return;
  }
  PixelSource pixel(layout, pixels, shown.values, shown.samples);
  for (int y = bounds.y0; y < bounds.y1; ++y) {
    const size_t place = static_cast<size_t>(y - spec_.crop.y0) * static_cast<size_t>(spec_.crop.width()) +
                         static_cast<size_t>(bounds.x0 - spec_.crop.x0);
    float* out = &picture.values[place * picture.channels.size()];
    for (int x = bounds.x0; x < bounds.x1; ++x, out += picture.channels.size()) {
      pixel.Next();
      picture.samples_min = std::min(picture.samples_min, static_cast<uint32_t>(pixel.samples()));
      painter.Paint(pixel, out);
    }
  }
}

}  // namespace tessera
