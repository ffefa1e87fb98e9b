#include "renderer/film/relight.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::string_view kGroupPrefix = "light_";
constexpr std::array<std::string_view, 3> kColors{"R", "G", "B"};

// Layers of light of other kinds, which a gain of a group would leave wrong.
constexpr std::string_view kStaleLayers[] = {"direct",   "indirect", "emission", "shadow",
                                             "variance", "halves",   "noisy"};

std::optional<size_t> IndexOf(const LoadedPicture& picture, const std::string& channel) {
  const auto found = std::ranges::find(picture.channels, channel);
  if (found == picture.channels.end()) return std::nullopt;
  return static_cast<size_t>(found - picture.channels.begin());
}

std::string LayerOfChannel(const std::string& channel) {
  const size_t dot = channel.rfind('.');
  return dot == std::string::npos ? std::string() : channel.substr(0, dot);
}

bool IsStale(const std::string& channel) {
  const std::string layer = LayerOfChannel(channel);
  return std::ranges::any_of(kStaleLayers, [&](std::string_view stale) {
    return layer == stale || layer.starts_with(std::string(stale) + "_");
  });
}

// A channel of the result: one of the picture, times a factor.
struct Output {
  size_t channel = 0;
  float factor = 1;
};
// What a colour is the sum of.
using ColorSum = std::vector<Output>;

Result<ColorSum> SumOfGroups(const LoadedPicture& picture, const std::vector<std::string>& groups,
                             std::span<const LightGain> gains, size_t color) {
  ColorSum sum;
  for (const std::string& group : groups) {
    const std::string name = fmt::format("{}{}.{}", kGroupPrefix, group, kColors[color]);
    const auto channel = IndexOf(picture, name);
    if (!channel) return BadInput(fmt::format("the picture has no channel \"{}\"", name));
    float factor = 1;
    for (const LightGain& gain : gains) {
      if (gain.group == group) factor *= gain.rgb[color];
    }
    sum.push_back({*channel, factor});
  }
  return sum;
}

Result<void> CheckGains(const std::vector<std::string>& groups, std::span<const LightGain> gains) {
  if (groups.empty())
    return BadInput(
        "the picture has no light groups: render it with --light-group, or with \"string group\" of its "
        "lights and --aov light_groups");
  const std::vector<std::string_view> known(groups.begin(), groups.end());
  for (const LightGain& gain : gains) {
    if (std::ranges::find(groups, gain.group) != groups.end()) continue;
    return BadInput(fmt::format("the picture has no light group \"{}\"{}; it has {}", OneLine(gain.group),
                                DidYouMean(gain.group, known), fmt::join(groups, ", ")));
  }
  return {};
}

}  // namespace

std::vector<std::string> LightGroupsOf(const LoadedPicture& picture) {
  std::vector<std::string> groups;
  for (const std::string& channel : picture.channels) {
    if (channel.starts_with(kGroupPrefix) && channel.ends_with(".R"))
      groups.push_back(LayerOfChannel(channel).substr(kGroupPrefix.size()));
  }
  std::ranges::sort(groups);
  return groups;
}

Result<LoadedPicture> Relight(const LoadedPicture& picture, std::span<const LightGain> gains) {
  const std::vector<std::string> groups = LightGroupsOf(picture);
  if (auto checked = CheckGains(groups, gains); !checked) return checked.error();
  LoadedPicture result = picture;
  result.channels.clear();
  result.types.clear();
  std::vector<ColorSum> outputs;
  std::vector<float> factors(picture.channels.size(), 1);
  std::array<ColorSum, 3> colors;
  for (size_t c = 0; c < colors.size(); ++c) {
    auto sum = SumOfGroups(picture, groups, gains, c);
    if (!sum) return sum.error();
    for (const Output& part : *sum) factors[part.channel] = part.factor;
    colors[c] = *std::move(sum);
    if (!IndexOf(picture, std::string(kColors[c])))
      return BadInput(fmt::format("the picture has no channel {}", kColors[c]));
  }
  for (size_t i = 0; i < picture.channels.size(); ++i) {
    if (IsStale(picture.channels[i])) continue;
    const auto color = std::ranges::find(kColors, picture.channels[i]);
    outputs.push_back(color == kColors.end() ? ColorSum{{i, factors[i]}}
                                             : colors[static_cast<size_t>(color - kColors.begin())]);
    result.channels.push_back(picture.channels[i]);
    result.types.push_back(i < picture.types.size() ? picture.types[i] : ExrType::kFloat);
  }
  const auto pixels = static_cast<size_t>(picture.bounds.area());
  result.values.assign(pixels * outputs.size(), 0.0f);
  for (size_t p = 0; p < pixels; ++p) {
    for (size_t i = 0; i < outputs.size(); ++i) {
      float sum = 0;
      for (const Output& part : outputs[i])
        sum += picture.values[p * picture.channels.size() + part.channel] * part.factor;
      result.values[p * outputs.size() + i] = sum;
    }
  }
  return result;
}

void SetLightTypes(LoadedPicture& picture, ExrType type) {
  picture.types.resize(picture.channels.size(), ExrType::kFloat);
  for (size_t c = 0; c < picture.channels.size(); ++c) {
    const std::string& name = picture.channels[c];
    // Light is what the film or a light has the colours of.
    if (IsColorChannel(name) || name == "A" || name.starts_with(kGroupPrefix)) picture.types[c] = type;
  }
}

}  // namespace tessera
