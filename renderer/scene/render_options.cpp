#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <type_traits>
#include <vector>

#include "renderer/description/number.h"
#include "renderer/scene/scene.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

// Bytes: all keys with the longest values fit.
constexpr size_t kTextSizeMax = 4096 + kLightGroupsMax * (kLightGroupNameMax + kLightGroupPatternMax + 2);
// ---- Values as text. FromText returns nullopt unless all of `text` is a value of the type, and finite.

std::string ToText(bool value) {
  return value ? "true" : "false";
}

std::optional<bool> FromText(std::string_view text, bool*) {
  if (text == "true") return true;
  if (text == "false") return false;
  return std::nullopt;
}

template <typename Number>
requires std::is_arithmetic_v<Number> std::string ToText(Number value) {
  char text[64];
  const std::to_chars_result result = std::to_chars(text, text + sizeof text, value);
  return std::string(text, result.ptr);
}

template <typename Number>
requires std::is_arithmetic_v<Number> std::optional<Number> FromText(std::string_view text, Number*) {
  const std::optional<Number> value = ParseNumber<Number>(text);
  if constexpr (std::is_floating_point_v<Number>) {
    if (value && !std::isfinite(*value)) return std::nullopt;
  }
  return value;
}

std::string ToText(const std::string& word) {
  return word;
}

std::optional<std::string> FromText(std::string_view text, std::string*) {
  return std::string(text);
}

std::vector<std::string_view> SplitAtCommas(std::string_view text) {
  std::vector<std::string_view> parts;
  for (size_t start = 0; start <= text.size();) {
    const size_t end = std::min(text.find(',', start), text.size());
    parts.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return parts;
}

template <typename Number>
using Four = std::array<Number, 4>;

template <typename Number>
std::string ToText(const Four<Number>& numbers) {
  return ToText(numbers[0]) + "," + ToText(numbers[1]) + "," + ToText(numbers[2]) + "," + ToText(numbers[3]);
}

template <typename Number>
std::optional<Four<Number>> FromText(std::string_view text, Four<Number>*) {
  const std::vector<std::string_view> parts = SplitAtCommas(text);
  Four<Number> numbers{};
  if (parts.size() != numbers.size()) return std::nullopt;
  for (size_t i = 0; i < numbers.size(); ++i) {
    const std::optional<Number> number = FromText(parts[i], static_cast<Number*>(nullptr));
    if (!number) return std::nullopt;
    numbers[i] = *number;
  }
  return numbers;
}

std::string ToText(ExrType type) {
  return type == ExrType::kHalf ? "half" : "float";
}

std::optional<ExrType> FromText(std::string_view text, ExrType*) {
  if (text == "half") return ExrType::kHalf;
  if (text == "float") return ExrType::kFloat;
  return std::nullopt;
}

std::string ToText(Denoiser denoiser) {
  return std::string(kDenoiserNames[static_cast<size_t>(denoiser)]);
}

std::optional<Denoiser> FromText(std::string_view text, Denoiser*) {
  const auto* const found = std::ranges::find(kDenoiserNames, text);
  if (found == std::end(kDenoiserNames)) return std::nullopt;
  return static_cast<Denoiser>(found - std::begin(kDenoiserNames));
}

std::string ToText(const std::set<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ","));
}

// Of AovNames.
std::optional<std::set<std::string>> FromText(std::string_view text, std::set<std::string>*) {
  const std::vector<std::string_view> known = AovNames();
  std::set<std::string> names;
  for (const std::string_view name : SplitAtCommas(text)) {
    if (std::ranges::find(known, name) == known.end()) return std::nullopt;
    names.emplace(name);
  }
  return names;
}

// Neither holds control characters.
constexpr char kRuleSeparator = '\t';

std::string ToText(const std::vector<LightGroupRule>& rules) {
  std::string text;
  for (const LightGroupRule& rule : rules) {
    if (!text.empty()) text += kRuleSeparator;
    text.append(rule.group).append("=").append(rule.pattern);
  }
  return text;
}

std::optional<std::vector<LightGroupRule>> FromText(std::string_view text, std::vector<LightGroupRule>*) {
  std::vector<LightGroupRule> rules;
  for (size_t start = 0; start <= text.size();) {
    const size_t end = std::min(text.find(kRuleSeparator, start), text.size());
    Result<LightGroupRule> rule = ParseLightGroupRule(text.substr(start, end - start));
    if (!rule || rules.size() == kLightGroupsMax) return std::nullopt;
    rules.push_back(*std::move(rule));
    start = end + 1;
  }
  return rules;
}

template <typename T>
std::string ToText(const std::optional<T>& value) {
  return ToText(*value);
}

template <typename T>
std::optional<std::optional<T>> FromText(std::string_view text, std::optional<T>*) {
  const std::optional<T> value = FromText(text, static_cast<T*>(nullptr));
  if (!value) return std::nullopt;
  return std::optional<std::optional<T>>(value);
}

// ---- One line of the codec per member of RenderOptions

struct Line {
  std::string_view key;
  // The value; nullopt if it is the default, which is not written.
  std::optional<std::string> (*encode)(const RenderOptions& options);
  // Returns false and changes nothing if `text` is not a value.
  bool (*decode)(std::string_view text, RenderOptions& options);
};

template <auto kMember>
constexpr Line LineOf(std::string_view key) {
  return {key,
          [](const RenderOptions& options) {
            if (options.*kMember == RenderOptions().*kMember) return std::optional<std::string>();
            return std::optional(ToText(options.*kMember));
          },
          [](std::string_view text, RenderOptions& options) {
            auto value = FromText(text, &(options.*kMember));
            if (!value) return false;
            options.*kMember = *std::move(value);
            return true;
          }};
}

// In order of key.
constexpr Line kLines[] = {
    LineOf<&RenderOptions::accelerator>("accelerator"),
    LineOf<&RenderOptions::aovs>("aov"),
    LineOf<&RenderOptions::crop>("crop"),
    LineOf<&RenderOptions::cryptomatte_levels>("cryptomatte-levels"),
    LineOf<&RenderOptions::denoise>("denoise"),
    LineOf<&RenderOptions::denoiser>("denoiser"),
    LineOf<&RenderOptions::disable_image_textures>("disable-image-textures"),
    LineOf<&RenderOptions::disable_pixel_jitter>("disable-pixel-jitter"),
    LineOf<&RenderOptions::disable_texture_filtering>("disable-texture-filtering"),
    LineOf<&RenderOptions::disable_wavelength_jitter>("disable-wavelength-jitter"),
    LineOf<&RenderOptions::displacement_edge_scale>("displacement-edge-scale"),
    LineOf<&RenderOptions::exr_type>("exr-type"),
    LineOf<&RenderOptions::force_diffuse>("force-diffuse"),
    LineOf<&RenderOptions::frames_per_second>("fps"),
    LineOf<&RenderOptions::frame>("frame"),
    LineOf<&RenderOptions::height>("height"),
    LineOf<&RenderOptions::integrator>("integrator"),
    LineOf<&RenderOptions::light_groups>("light-group"),
    LineOf<&RenderOptions::max_depth>("max-depth"),
    LineOf<&RenderOptions::noise_threshold>("noise-threshold"),
    LineOf<&RenderOptions::pixel_bounds>("pixelbounds"),
    LineOf<&RenderOptions::quick>("quick"),
    LineOf<&RenderOptions::seed>("seed"),
    LineOf<&RenderOptions::samples_per_pixel>("spp"),
    LineOf<&RenderOptions::tile_size>("tile-size"),
    LineOf<&RenderOptions::time>("time"),
    LineOf<&RenderOptions::time_step>("time-step"),
    LineOf<&RenderOptions::width>("width"),
};

Result<void> DecodeLine(std::string_view text, RenderOptions& options) {
  const size_t equals = text.find('=');
  if (equals == std::string_view::npos) return BadInput("render options: a line without \"=\"");
  const std::string_view key = text.substr(0, equals);
  const auto* line = std::ranges::find(kLines, key, &Line::key);
  if (line == std::end(kLines)) {
    std::vector<std::string_view> keys;
    for (const Line& known : kLines) keys.push_back(known.key);
    return BadInput(fmt::format("render options: unknown key \"{}\"{}", key, DidYouMean(key, keys)));
  }
  if (!line->decode(text.substr(equals + 1), options))
    return BadInput(fmt::format("render options: bad value of \"{}\"", key));
  return {};
}

}  // namespace

std::string EncodeRenderOptions(const RenderOptions& options) {
  std::string text;
  for (const Line& line : kLines) {
    if (const std::optional<std::string> value = line.encode(options))
      text.append(line.key).append("=").append(*value).append("\n");
  }
  return text;
}

Result<RenderOptions> DecodeRenderOptions(const std::string& text) {
  if (text.size() > kTextSizeMax) {
    return BadInput(
        fmt::format("the render options have {} bytes, expected at most {}", text.size(), kTextSizeMax));
  }
  RenderOptions options;
  std::string_view rest = text;
  while (!rest.empty()) {
    const size_t end = std::min(rest.find('\n'), rest.size());
    if (Result<void> decoded = DecodeLine(rest.substr(0, end), options); !decoded) return decoded.error();
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return options;
}

}  // namespace tessera
