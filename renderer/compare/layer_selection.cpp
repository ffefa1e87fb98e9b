#include "renderer/compare/layer_selection.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "renderer/util/text.h"

namespace tessera {
namespace {

std::string LayerOf(const std::string& channel) {
  const size_t dot = channel.rfind('.');
  if (dot != std::string::npos) return channel.substr(0, dot);
  return IsColorChannel(channel) || channel == "A" ? kColorLayer : channel;
}

std::string NameInLayer(const std::string& channel) {
  const size_t dot = channel.rfind('.');
  return dot == std::string::npos ? channel : channel.substr(dot + 1);
}

}  // namespace

std::vector<std::string> LayersOf(const std::vector<std::string>& channels) {
  std::vector<std::string> layers;
  for (const std::string& channel : channels) {
    const std::string layer = LayerOf(channel);
    if (std::ranges::find(layers, layer) == layers.end()) layers.push_back(layer);
  }
  return layers;
}

Result<LoadedPicture> SelectLayer(const LoadedPicture& picture, const std::string& layer,
                                  const std::string& name) {
  LoadedPicture selected;
  selected.width = picture.width;
  selected.height = picture.height;
  selected.bounds = picture.bounds;
  selected.attributes = picture.attributes;
  std::vector<size_t> sources;
  for (size_t c = 0; c < picture.channels.size(); ++c) {
    if (LayerOf(picture.channels[c]) != layer) continue;
    sources.push_back(c);
    selected.channels.push_back(NameInLayer(picture.channels[c]));
  }
  if (sources.empty()) {
    std::vector<std::string> layers;
    for (const std::string& known : LayersOf(picture.channels)) layers.push_back(OneLine(known));
    return BadInput(
        fmt::format("{}: no layer \"{}\"; it has {}", name, OneLine(layer), fmt::join(layers, ", ")));
  }
  const size_t pixels = static_cast<size_t>(picture.bounds.area());
  selected.values.reserve(pixels * sources.size());
  for (size_t i = 0; i < pixels; ++i) {
    for (const size_t c : sources) selected.values.push_back(picture.values[i * picture.channels.size() + c]);
  }
  return selected;
}

}  // namespace tessera
