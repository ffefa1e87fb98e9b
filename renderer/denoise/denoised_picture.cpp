#include "renderer/denoise/denoised_picture.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "renderer/denoise/denoise.h"
#include "renderer/film/relight.h"

namespace tessera {

namespace {

constexpr const char* kNames[] = {"R", "G", "B"};

// A channel of the result: one of the picture, or a denoised value.
struct Output {
  size_t place = 0;
  bool is_denoised = false;
};

// The channels of the result, by name.
class Outputs {
 public:
  Outputs(const LoadedPicture& picture, LoadedPicture& result) : picture_(picture), result_(result) {}

  // `like`: the channel of the picture whose type it has.
  void Add(std::string name, size_t like, Output output) {
    result_.channels.push_back(std::move(name));
    result_.types.push_back(like < picture_.types.size() ? picture_.types[like] : ExrType::kFloat);
    outputs_.push_back(output);
  }
  // The three channels of a layer, denoised, and as they were in the layer `noisy`.
  void AddLayer(const std::string& prefix, const std::string& noisy, const std::array<size_t, kColors>& color,
                size_t denoised) {
    for (size_t c = 0; c < kColors; ++c) {
      Add(prefix + kNames[c], color[c], {denoised + c, true});
      Add(noisy + "." + kNames[c], color[c], {color[c], false});
    }
  }
  const std::vector<Output>& all() const { return outputs_; }

 private:
  const LoadedPicture& picture_;
  LoadedPicture& result_;
  std::vector<Output> outputs_;
};

}  // namespace

void SettleColors(const float* pixel, const InputLayers& layers, float* denoised) {
  for (size_t c = 0; c < kColors; ++c) {
    const float noisy = pixel[layers.color[c]];
    float& color = denoised[c];
    color = std::max(color, noisy < 0 ? noisy : 0.0f);
    float sum = 0;
    for (size_t g = 1; g <= layers.groups.size(); ++g) {
      float& light = denoised[g * kColors + c];
      light = std::max(light, 0.0f);
      sum += light;
    }
    const auto groups = static_cast<float>(layers.groups.size());
    for (size_t g = 1; g <= layers.groups.size(); ++g) {
      float& light = denoised[g * kColors + c];
      light = sum > 0 ? light / sum * color : color / groups;
    }
  }
}

LoadedPicture WithColors(const LoadedPicture& picture, const InputLayers& layers,
                         const DenoisedColors& colors) {
  LoadedPicture result;
  result.width = picture.width;
  result.height = picture.height;
  result.bounds = picture.bounds;
  result.format = picture.format;
  result.attributes = picture.attributes;
  result.attributes[kDenoiserAttribute] = colors.denoiser;
  result.attributes.erase(kDenoiseFailedAttribute);
  Outputs outputs(picture, result);
  std::set<std::string> replaced;
  const auto add_layer = [&](const std::string& layer, const std::string& noisy,
                             const std::array<size_t, kColors>& color, size_t denoised) {
    const std::string prefix = layer.empty() ? "" : layer + ".";
    for (const char* name : kNames) replaced.insert({prefix + name, noisy + "." + name});
    outputs.AddLayer(prefix, noisy, color, denoised);
  };
  add_layer("", kNoisyLayer, layers.color, 0);
  for (size_t g = 0; g < layers.groups.size(); ++g) {
    const GroupLayer& group = layers.groups[g];
    add_layer(group.name, NoisyLayerOf(group.name), group.color, (g + 1) * kColors);
  }
  for (size_t c = 0; c < picture.channels.size(); ++c) {
    if (!replaced.contains(picture.channels[c])) outputs.Add(picture.channels[c], c, {c, false});
  }
  const size_t pixels = static_cast<size_t>(picture.bounds.area());
  const size_t signals = (1 + layers.groups.size()) * kColors;
  result.values.reserve(pixels * result.channels.size());
  for (size_t i = 0; i < pixels; ++i) {
    const float* const pixel = &picture.values[i * picture.channels.size()];
    for (const Output& output : outputs.all())
      result.values.push_back(output.is_denoised ? colors.values[i * signals + output.place]
                                                 : pixel[output.place]);
  }
  return result;
}

std::string NoisyLayerOf(const std::string& layer) {
  return std::string(kNoisyLayer) + "_" + layer;
}

std::vector<std::string> AddedLayers(const LoadedPicture& picture) {
  std::vector<std::string> layers{kNoisyLayer};
  for (const std::string& group : LightGroupsOf(picture)) layers.push_back(NoisyLayerOf("light_" + group));
  std::erase_if(layers, [&](const std::string& layer) {
    return std::ranges::find(picture.channels, layer + ".R") != picture.channels.end();
  });
  return layers;
}

}  // namespace tessera
