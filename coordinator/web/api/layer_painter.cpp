#include "coordinator/web/api/layer_painter.h"

#include <algorithm>

#include "coordinator/web/api/tile_progress.h"

namespace tessera {
namespace {

constexpr const char* kVarianceChannel = "variance.R";

// The places of the layer's channels; nullopt if some are missing.
std::optional<std::vector<size_t>> PlacesOf(const PictureLayer& layer,
                                            const std::vector<std::string>& channels) {
  std::vector<size_t> places;
  for (const std::string& name : layer.channels) {
    const auto found = std::ranges::find(channels, name);
    if (found == channels.end()) return std::nullopt;
    places.push_back(static_cast<size_t>(found - channels.begin()));
  }
  return places;
}

// The picture with the channels at `places` alone.
FramePicture Only(const FramePicture& picture, const PictureLayer& layer, const std::vector<size_t>& places) {
  FramePicture only{picture.bounds, layer.channels, {}, picture.samples_min};
  only.values.reserve(static_cast<size_t>(picture.bounds.area()) * places.size());
  for (size_t at = 0; at < picture.values.size(); at += picture.channels.size()) {
    for (const size_t place : places) only.values.push_back(picture.values[at + place]);
  }
  return only;
}

// Values of all pixels of a tile, of which the picture shows those that a stream has.
FramePicture Reduced(const FrameSpec& spec, int tile, int step, const std::vector<float>& values,
                     const PictureLayer& layer) {
  const PixelBounds bounds = spec.TileBounds(tile);
  const int x0 = bounds.x0 - spec.crop.x0, y0 = bounds.y0 - spec.crop.y0;
  const auto reduced = [step](int position) { return (position + step - 1) / step; };
  FramePicture picture;
  picture.bounds = {reduced(x0), reduced(y0), reduced(x0 + bounds.width()), reduced(y0 + bounds.height())};
  picture.channels = layer.channels;
  for (int y = picture.bounds.y0; y < picture.bounds.y1; ++y) {
    for (int x = picture.bounds.x0; x < picture.bounds.x1; ++x)
      picture.values.push_back(values[static_cast<size_t>((y * step - y0) * bounds.width() + x * step - x0)]);
  }
  return picture;
}

// Every step-th pixel, all channels.
FramePicture Reduced(const LoadedPicture& file, int step) {
  FramePicture picture;
  picture.bounds = {0, 0, (file.bounds.width() + step - 1) / step, (file.bounds.height() + step - 1) / step};
  picture.channels = file.channels;
  const size_t channels = file.channels.size();
  picture.values.reserve(static_cast<size_t>(picture.bounds.area()) * channels);
  for (int y = 0; y < picture.bounds.y1; ++y) {
    for (int x = 0; x < picture.bounds.x1; ++x) {
      const auto row = static_cast<size_t>(y * step) * static_cast<size_t>(file.bounds.width());
      const float* const pixel = &file.values[(row + static_cast<size_t>(x * step)) * channels];
      picture.values.insert(picture.values.end(), pixel, pixel + channels);
    }
  }
  return picture;
}

}  // namespace

std::optional<FramePicture> LayerPainter::Tile(const FrameSnapshot& snapshot, int tile, int step) const {
  const FrameSpec& spec = snapshot.spec();
  const PixelBounds bounds = spec.TileBounds(tile);
  if (layer_.name == kSamplesLayer)
    return Reduced(spec, tile, step, SamplesOfTile(spec, snapshot.NodesOf(tile), bounds), layer_);
  if (layer_.name == kNoiseLayer && spec.Layout().SlotOf(kVarianceChannel)) {
    FramePicture picture = snapshot.TilePicture(tile, step);
    auto noise = NoiseFromVariance(picture.channels, picture.values);
    if (noise) return FramePicture{picture.bounds, layer_.channels, std::move(*noise), 0};
  }
  if (layer_.name == kNoiseLayer) {
    const auto noise = NoiseOfTile(spec, snapshot.NodesOf(tile), bounds);
    if (!noise) return std::nullopt;
    return Reduced(spec, tile, step, *noise, layer_);
  }
  const FramePicture picture = snapshot.TilePicture(tile, step);
  const auto places = PlacesOf(layer_, picture.channels);
  if (!places) return std::nullopt;
  return Only(picture, layer_, *places);
}

std::optional<FramePicture> LayerPainter::File(const FrameSpec& spec, const LoadedPicture& file,
                                               int step) const {
  const FramePicture picture = Reduced(file, step);
  if (layer_.name == kNoiseLayer) {
    auto noise = NoiseFromVariance(picture.channels, picture.values);
    if (!noise) return std::nullopt;
    return FramePicture{picture.bounds, layer_.channels, std::move(*noise), 0};
  }
  if (const auto places = PlacesOf(layer_, picture.channels)) return Only(picture, layer_, *places);
  if (layer_.name != kSamplesLayer || spec.IsAdaptive()) return std::nullopt;
  FramePicture samples{picture.bounds, layer_.channels, {}, 0};
  samples.values.assign(static_cast<size_t>(picture.bounds.area()),
                        static_cast<float>(spec.samples_per_pixel));
  return samples;
}

}  // namespace tessera
