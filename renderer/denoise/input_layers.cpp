#include "renderer/denoise/input_layers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "renderer/denoise/denoise.h"
#include "renderer/film/relight.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

using Three = std::array<size_t, kColors>;

std::optional<size_t> Find(const LoadedPicture& picture, const std::string& channel) {
  const auto found = std::ranges::find(picture.channels, channel);
  if (found == picture.channels.end()) return std::nullopt;
  return static_cast<size_t>(found - picture.channels.begin());
}

// The channels "PREFIXa", "PREFIXb" and "PREFIXc" of the components "abc".
std::optional<Three> FindThree(const LoadedPicture& picture, const std::string& prefix,
                               const std::string& components) {
  Three places{};
  for (size_t i = 0; i < kColors; ++i) {
    const auto place = Find(picture, prefix + components[i]);
    if (!place) return std::nullopt;
    places[i] = *place;
  }
  return places;
}

// The layer "halves" counts every fourth to seventh of eight samples to the second half (scene/layers.cpp).
constexpr uint32_t kHalvesPeriod = 8;

// How many samples each half has of each pixel. Adaptive pixels stop at multiples of the period.
Result<std::array<float, 2>> HalfScales(const LoadedPicture& picture, const std::string& name) {
  const auto attribute = picture.attributes.find("tessera:samplesPerPixel");
  if (attribute == picture.attributes.end() || picture.attributes.contains("tessera:noiseThreshold"))
    return std::array<float, 2>{1, 1};
  const std::string& text = attribute->second;
  uint32_t samples = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), samples);
  if (error != std::errc() || end != text.data() + text.size() || samples == 0)
    return BadInput(fmt::format(
        "{}: its attribute tessera:samplesPerPixel is \"{}\", not a number of samples", name, OneLine(text)));
  const uint32_t first =
      samples / kHalvesPeriod * (kHalvesPeriod / 2) + std::min(samples % kHalvesPeriod, kHalvesPeriod / 2);
  if (first == samples) {
    return BadInput(fmt::format("{}: is rendered with {} samples per pixel; denoising needs at least {}",
                                name, samples, kHalvesPeriod));
  }
  const auto half = 0.5f * static_cast<float>(samples);
  return std::array<float, 2>{half / static_cast<float>(first), half / static_cast<float>(samples - first)};
}

// As they were rendered, whether or not the picture is denoised already.
std::vector<GroupLayer> FindGroups(const LoadedPicture& picture) {
  std::vector<GroupLayer> groups;
  for (const std::string& group : LightGroupsOf(picture)) {
    GroupLayer layer{"light_" + group};
    auto color = FindThree(picture, NoisyLayerOf(layer.name) + ".", "RGB");
    if (!color) color = FindThree(picture, layer.name + ".", "RGB");
    if (!color) continue;
    layer.color = *color;
    groups.push_back(std::move(layer));
  }
  return groups;
}

}  // namespace

Result<InputLayers> FindInputLayers(const LoadedPicture& picture, const std::string& name,
                                    Denoiser denoiser) {
  const bool needs_halves = denoiser == Denoiser::kRegression;
  InputLayers layers;
  layers.groups = FindGroups(picture);
  std::vector<std::string> missing;
  const auto take = [&](const char* layer, const std::optional<Three>& found, Three& places) {
    if (found) places = *found;
    if (!found) missing.emplace_back(layer);
  };
  auto color = FindThree(picture, std::string(kNoisyLayer) + ".", "RGB");
  if (!color) color = FindThree(picture, "", "RGB");
  take("RGB", color, layers.color);
  take("albedo", FindThree(picture, "albedo.", "RGB"), layers.albedo);
  auto normal = FindThree(picture, "normal.", "XYZ");
  if (!normal) normal = FindThree(picture, "N.", "XYZ");
  take("normal", normal, layers.normal);
  layers.guiding_albedo = FindThree(picture, "denoising_albedo.", "RGB").value_or(layers.albedo);
  layers.guiding_normal = FindThree(picture, "denoising_normal.", "XYZ").value_or(layers.normal);
  auto depth = Find(picture, "depth.Z");
  if (!depth) depth = Find(picture, "Z");
  layers.has_depth = depth.has_value();
  if (depth) layers.depth = *depth;
  if (!depth && needs_halves) missing.emplace_back("depth");
  const auto halves = FindThree(picture, "halves.", "RGB");
  layers.has_halves = halves.has_value();
  if (halves || needs_halves) take("halves", halves, layers.halves);
  if (missing.empty() && !needs_halves) return layers;
  if (missing.empty()) {
    const auto scales = HalfScales(picture, name);
    if (!scales) return scales.error();
    layers.half_scales = *scales;
    return layers;
  }
  return BadInput(fmt::format("{}: cannot be denoised without the layer{} {}; render it with --aov denoise",
                              name, missing.size() == 1 ? "" : "s", fmt::join(missing, ", ")));
}

float LargestDepth(const LoadedPicture& picture, size_t depth) {
  float largest = 0;
  for (size_t i = depth; i < picture.values.size(); i += picture.channels.size()) {
    const float value = picture.values[i];
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  return largest > 0 ? largest : 1;
}

}  // namespace tessera
