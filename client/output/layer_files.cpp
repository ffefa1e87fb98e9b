#include "client/output/layer_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace tessera {
namespace {

constexpr std::string_view kMatteKey = "cryptomatte/";

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

// The layers that the header calls mattes.
std::vector<std::string> MattesOf(const std::map<std::string, std::string>& attributes) {
  std::vector<std::string> mattes;
  for (const auto& [name, value] : attributes) {
    if (name.starts_with(kMatteKey) && name.ends_with("/name")) mattes.push_back(value);
  }
  return mattes;
}

// Without the names of mattes of other layers.
std::map<std::string, std::string> AttributesOf(const std::string& layer, const LoadedPicture& picture) {
  std::map<std::string, std::string> kept;
  for (const auto& [name, value] : picture.attributes) {
    if (name.starts_with(kMatteKey)) {
      const auto owner = picture.attributes.find(name.substr(0, name.rfind('/')) + "/name");
      if (owner == picture.attributes.end() || owner->second != layer) continue;
    }
    kept[name] = value;
  }
  return kept;
}

LoadedPicture Select(const LoadedPicture& whole, const std::vector<size_t>& channels,
                     const std::string& layer) {
  LoadedPicture picture{whole.width, whole.height, whole.bounds, {}, {}, AttributesOf(layer, whole),
                        {},          whole.format};
  for (const size_t c : channels) {
    picture.channels.push_back(whole.channels[c]);
    picture.types.push_back(whole.types[c]);
  }
  const size_t pixels = whole.values.size() / whole.channels.size();
  picture.values.reserve(pixels * channels.size());
  for (size_t p = 0; p < pixels; ++p) {
    for (const size_t c : channels) picture.values.push_back(whole.values[p * whole.channels.size() + c]);
  }
  return picture;
}

Result<void> CheckChannel(const std::string& name, ExrType type, const ExrOutput& output) {
  const bool is_exact = type == ExrType::kFloat && !LayerOf(name, {}).empty();
  if (!is_exact || !output.compression || output.splits_layers || !MayChange(*output.compression, name, type))
    return {};
  return BadInput(
      fmt::format("--compression {} would change channel \"{}\", which must stay exact: use one that loses "
                  "nothing (none, rle, zips, zip, piz), or --aov-split",
                  NameOf(*output.compression), name));
}

}  // namespace

std::string LayerOf(const std::string& channel, const std::vector<std::string>& mattes) {
  const size_t dot = channel.rfind('.');
  if (dot == std::string::npos) {
    const bool is_color = channel == "R" || channel == "G" || channel == "B" || channel == "A";
    return is_color ? "" : channel;
  }
  std::string layer = channel.substr(0, dot);
  if (layer.size() < 3 || !IsDigit(layer[layer.size() - 1]) || !IsDigit(layer[layer.size() - 2]))
    return layer;
  const std::string matte = layer.substr(0, layer.size() - 2);
  return std::ranges::find(mattes, matte) != mattes.end() ? matte : layer;
}

std::string FileLayer(const std::string& layer) {
  constexpr size_t kBytesMax = 64;
  std::string name = layer.substr(0, kBytesMax);
  for (char& c : name) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (!is_letter && !IsDigit(c) && c != '-') c = '_';
  }
  return name;
}

std::set<std::string> FileLayersOf(const FrameSpec& frame) {
  const std::vector<std::string> mattes = MattesOf(frame.attributes);
  std::set<std::string> layers;
  for (const PictureChannel& channel : frame.PictureChannels()) {
    const std::string layer = LayerOf(channel.name, mattes);
    if (!layer.empty()) layers.insert(FileLayer(layer));
  }
  return layers;
}

Result<std::vector<LayerPicture>> SplitLayers(const LoadedPicture& picture) {
  const std::vector<std::string> mattes = MattesOf(picture.attributes);
  std::map<std::string, std::vector<size_t>> layers;
  for (size_t c = 0; c < picture.channels.size(); ++c)
    layers[LayerOf(picture.channels[c], mattes)].push_back(c);
  std::set<std::string> files;
  std::vector<LayerPicture> pictures;
  for (const auto& [layer, channels] : layers) {
    if (!files.insert(FileLayer(layer)).second)
      return Failed(fmt::format("two layers of the picture would be in one file, \"{}\"", FileLayer(layer)));
    pictures.push_back({layer, Select(picture, channels, layer)});
  }
  return pictures;
}

Result<void> CheckCompression(const FrameSpec& frame, const ExrOutput& output) {
  for (const PictureChannel& channel : frame.PictureChannels()) {
    if (auto ok = CheckChannel(channel.name, channel.is_exact ? ExrType::kFloat : frame.exr_type, output);
        !ok)
      return ok;
  }
  return {};
}

Result<void> CheckCompression(const LoadedPicture& picture, const ExrOutput& output) {
  for (size_t c = 0; c < picture.channels.size(); ++c) {
    if (auto ok = CheckChannel(picture.channels[c], picture.types[c], output); !ok) return ok;
  }
  return {};
}

ExrFormat FormatOf(const LoadedPicture& picture, const ExrOutput& output) {
  ExrFormat format = picture.format;
  if (output.compression) format.compression = *output.compression;
  if (output.layout) format.is_tiled = *output.layout == ExrLayout::kTiles;
  format.has_preview |= output.has_preview;
  return format;
}

ExrFormat FormatOf(const LayerPicture& layer, const ExrOutput& output) {
  ExrFormat format = FormatOf(layer.picture, output);
  ExrOutput whole;
  whole.compression = format.compression;
  if (!CheckCompression(layer.picture, whole)) format.compression = ExrCompression::kZip;
  return format;
}

}  // namespace tessera
