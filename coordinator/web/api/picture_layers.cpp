#include "coordinator/web/api/picture_layers.h"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

namespace tessera {
namespace {

constexpr std::string_view kLightPrefix = "light_";  // of the layers of light groups
constexpr std::string_view kMattePrefix = "Crypto";  // ids by rank are no colours
constexpr size_t kLayerChannelsMax = 3;
constexpr std::string_view kOrder = "RGBXYZUV";  // of the channels of a layer

// Where a channel comes in its layer.
size_t OrderOf(const std::string& channel) {
  const std::string_view last = std::string_view(channel).substr(channel.rfind('.') + 1);
  return last.size() == 1 ? kOrder.find(last) : std::string_view::npos;
}

std::vector<std::string> ColorsOf(const std::vector<PictureChannel>& channels) {
  std::vector<std::string> colors;
  for (const char* color : {"R", "G", "B"}) {
    const bool has = std::ranges::find(channels, color, &PictureChannel::name) != channels.end();
    colors.push_back(has ? color : channels.front().name);
  }
  return colors;
}

// Channels by layer, in the order of the file.
std::vector<PictureLayer> GroupByLayer(const std::vector<PictureChannel>& channels) {
  std::vector<PictureLayer> layers;
  for (const PictureChannel& channel : channels) {
    if (channel.name.starts_with(kMattePrefix) || IsColorChannel(channel.name)) continue;
    const size_t dot = channel.name.rfind('.');
    const std::string name = channel.name.substr(0, dot);
    auto layer = std::ranges::find(layers, name, &PictureLayer::name);
    if (layer == layers.end()) layer = layers.insert(layers.end(), {name, {}, false});
    layer->channels.push_back(channel.name);
    layer->is_exact = layer->is_exact || channel.is_exact;
  }
  return layers;
}

}  // namespace

std::vector<PictureLayer> LayersOf(const FrameSpec& spec) {
  const std::vector<PictureChannel> channels = spec.PictureChannels();
  std::vector<PictureLayer> layers;
  if (channels.empty()) return layers;
  layers.push_back({"", ColorsOf(channels), false});
  PictureLayer lights{kLightsLayer, {}, false};
  for (PictureLayer& layer : GroupByLayer(channels)) {
    std::ranges::stable_sort(layer.channels, {}, OrderOf);
    if (layer.channels.size() > kLayerChannelsMax) {  // such as the ranges of wavelengths of a spectral film
      for (const std::string& channel : layer.channels)
        layers.push_back({channel, {channel}, layer.is_exact});
      continue;
    }
    if (layer.name.starts_with(kLightPrefix) && layer.channels.size() == kLayerChannelsMax)
      lights.channels.insert(lights.channels.end(), layer.channels.begin(), layer.channels.end());
    layers.push_back(std::move(layer));
  }
  if (!lights.channels.empty()) layers.push_back(std::move(lights));
  layers.push_back({kSamplesLayer, {"samples"}, true});
  layers.push_back({kNoiseLayer, {"noise"}, true});
  return layers;
}

std::optional<PictureLayer> FindLayer(const FrameSpec& spec, const std::string& name) {
  for (PictureLayer& layer : LayersOf(spec)) {
    if (layer.name == name) return std::move(layer);
  }
  return std::nullopt;
}

}  // namespace tessera
