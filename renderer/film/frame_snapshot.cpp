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

FramePicture FrameSnapshot::PictureOf(const FrameSpec& spec, int step) const {
  const ChannelLayout layout = spec_.Layout();
  const TilePainter painter(spec_.PictureChannels(), layout);
  FramePicture picture;
  picture.bounds = spec.crop;
  picture.channels = painter.Names();
  picture.samples_min = tiles_.empty() ? 0 : spec_.samples_per_pixel;
  picture.values.assign(static_cast<size_t>(spec.crop.area()) * picture.channels.size(), 0.0f);
  const PixelBounds window{0, 0, spec.crop.width(), spec.crop.height()};
  for (int tile = 0; tile < static_cast<int>(tiles_.size()); ++tile)
    Paint(tile, painter, step, window, picture);
  return picture;
}

FrameSnapshot::Preview FrameSnapshot::MakePreview(int64_t values_max) const {
  const auto channels = static_cast<int64_t>(spec_.PictureChannels().size());
  const auto reduced = [](int size, int step) { return (size + step - 1) / step; };
  Preview preview;
  preview.spec = spec_;
  int step = 1;
  while (preview.spec.crop.area() * channels > values_max) {
    ++step;
    const int x0 = spec_.crop.x0 / step, y0 = spec_.crop.y0 / step;
    preview.spec.crop = {x0, y0, x0 + reduced(spec_.crop.width(), step),
                         y0 + reduced(spec_.crop.height(), step)};
    preview.spec.width = std::max(reduced(spec_.width, step), preview.spec.crop.x1);
    preview.spec.height = std::max(reduced(spec_.height, step), preview.spec.crop.y1);
  }
  preview.picture = PictureOf(preview.spec, step);
  return preview;
}

const FrameSnapshot::TileNodes& FrameSnapshot::NodesOf(int tile) const {
  static const TileNodes kNothing;
  const auto index = static_cast<size_t>(tile);
  return index < tiles_.size() ? tiles_[index] : kNothing;
}

// Sums are shared and never change, so the same sums are at the same address.
bool FrameSnapshot::IsSameTile(int tile, const FrameSnapshot& other) const {
  return std::ranges::equal(NodesOf(tile), other.NodesOf(tile), [](const auto& a, const auto& b) {
    return a.first == b.first && a.second.operator->() == b.second.operator->();
  });
}

FramePicture FrameSnapshot::TilePicture(int tile, int step) const {
  const ChannelLayout layout = spec_.Layout();
  const TilePainter painter(spec_.PictureChannels(), layout);
  const auto reduced = [step](int position) { return (position + step - 1) / step; };
  PixelBounds bounds = spec_.TileBounds(tile);
  bounds = {reduced(bounds.x0 - spec_.crop.x0), reduced(bounds.y0 - spec_.crop.y0),
            reduced(bounds.x1 - spec_.crop.x0), reduced(bounds.y1 - spec_.crop.y0)};
  FramePicture picture;
  picture.bounds = bounds;
  picture.channels = painter.Names();
  picture.samples_min = tiles_.empty() ? 0 : spec_.samples_per_pixel;
  picture.values.assign(static_cast<size_t>(bounds.area()) * picture.channels.size(), 0.0f);
  if (!tiles_.empty()) Paint(tile, painter, step, bounds, picture);
  return picture;
}

void FrameSnapshot::Paint(int tile, const TilePainter& painter, int step, const PixelBounds& window,
                          FramePicture& picture) const {
  const PixelBounds bounds = spec_.TileBounds(tile);
  const auto pixels = static_cast<size_t>(bounds.area());
  const ChannelLayout& layout = painter.layout();
  const NodeSum shown = SumOfNodes(layout.shape(), pixels, tiles_[static_cast<size_t>(tile)]);
  if (shown.samples == 0) {
    picture.samples_min = 0;
    return;
  }
  PixelSource pixel(layout, pixels, shown.values, shown.samples);
  for (int y = bounds.y0 - spec_.crop.y0; y < bounds.y1 - spec_.crop.y0; ++y) {
    for (int x = bounds.x0 - spec_.crop.x0; x < bounds.x1 - spec_.crop.x0; ++x) {
      pixel.Next();
      picture.samples_min = std::min(picture.samples_min, static_cast<uint32_t>(pixel.samples()));
      if (x % step != 0 || y % step != 0) continue;
      const auto row = static_cast<size_t>(y / step - window.y0) * static_cast<size_t>(window.width());
      const size_t place = row + static_cast<size_t>(x / step - window.x0);
      painter.Paint(pixel, &picture.values[place * picture.channels.size()]);
    }
  }
}

}  // namespace tessera
