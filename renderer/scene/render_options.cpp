#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "renderer/scene/layers.h"
#include "renderer/scene/scene.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr size_t kTextSizeMax = 4096;  // bytes: all keys with the longest values fit
constexpr std::string_view kKeys[] = {
    "accelerator",     "aov",  "crop", "exr-type",  "height", "integrator", "max-depth",
    "noise-threshold", "seed", "spp",  "tile-size", "time",   "width"};

template <typename T>
std::string NumberText(T value) {
  char text[64];
  const std::to_chars_result result = std::to_chars(text, text + sizeof text, value);
  return std::string(text, result.ptr);
}

// The whole of `text` as a number.
template <typename T>
bool ReadNumber(std::string_view text, T* value) {
  const std::from_chars_result result = std::from_chars(text.data(), text.data() + text.size(), *value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

template <typename T>
bool ReadOptional(std::string_view text, std::optional<T>* value) {
  T number{};
  if (!ReadNumber(text, &number)) return false;
  *value = number;
  return true;
}

bool ReadCrop(std::string_view text, std::optional<std::array<float, 4>>* crop) {
  std::array<float, 4> fractions{};
  for (int i = 0; i < 4; ++i) {
    const size_t comma = i < 3 ? text.find(',') : text.size();
    if (comma == std::string_view::npos || !ReadNumber(text.substr(0, comma), &fractions[i])) return false;
    text.remove_prefix(i < 3 ? comma + 1 : comma);
  }
  *crop = fractions;
  return true;
}

bool ReadExrType(std::string_view text, std::optional<ExrType>* type) {
  if (text != "half" && text != "float") return false;
  *type = text == "half" ? ExrType::kHalf : ExrType::kFloat;
  return true;
}

// Names separated by commas.
bool ReadAovs(std::string_view text, std::set<std::string>* aovs) {
  while (!text.empty()) {
    const size_t end = std::min(text.find(','), text.size());
    const std::string_view name = text.substr(0, end);
    if (Layers().Find(name) == nullptr) return false;
    aovs->emplace(name);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return !aovs->empty();
}

std::string AovsText(const std::set<std::string>& aovs) {
  std::string text;
  for (const std::string& name : aovs) text += (text.empty() ? "" : ",") + name;
  return text;
}

bool ReadOption(std::string_view key, std::string_view value, RenderOptions* options) {
  if (key == "accelerator") return options->accelerator = value, true;
  if (key == "aov") return ReadAovs(value, &options->aovs);
  if (key == "crop") return ReadCrop(value, &options->crop);
  if (key == "exr-type") return ReadExrType(value, &options->exr_type);
  if (key == "height") return ReadOptional(value, &options->height);
  if (key == "integrator") return options->integrator = value, true;
  if (key == "max-depth") return ReadOptional(value, &options->max_depth);
  if (key == "noise-threshold") return ReadNumber(value, &options->noise_threshold);
  if (key == "seed") return ReadOptional(value, &options->seed);
  if (key == "spp") return ReadOptional(value, &options->samples_per_pixel);
  if (key == "tile-size") return ReadOptional(value, &options->tile_size);
  if (key == "time") return ReadOptional(value, &options->time) && std::isfinite(*options->time);
  if (key == "width") return ReadOptional(value, &options->width);
  return false;
}

}  // namespace

std::string EncodeRenderOptions(const RenderOptions& options) {
  std::map<std::string, std::string> lines;
  if (!options.accelerator.empty()) lines["accelerator"] = options.accelerator;
  if (!options.aovs.empty()) lines["aov"] = AovsText(options.aovs);
  if (options.crop) {
    const std::array<float, 4>& c = *options.crop;
    lines["crop"] =
        NumberText(c[0]) + "," + NumberText(c[1]) + "," + NumberText(c[2]) + "," + NumberText(c[3]);
  }
  if (options.exr_type) lines["exr-type"] = *options.exr_type == ExrType::kHalf ? "half" : "float";
  if (options.height) lines["height"] = NumberText(*options.height);
  if (!options.integrator.empty()) lines["integrator"] = options.integrator;
  if (options.max_depth) lines["max-depth"] = NumberText(*options.max_depth);
  if (options.noise_threshold != 0) lines["noise-threshold"] = NumberText(options.noise_threshold);
  if (options.seed) lines["seed"] = NumberText(*options.seed);
  if (options.samples_per_pixel) lines["spp"] = NumberText(*options.samples_per_pixel);
  if (options.tile_size) lines["tile-size"] = NumberText(*options.tile_size);
  if (options.time) lines["time"] = NumberText(*options.time);
  if (options.width) lines["width"] = NumberText(*options.width);
  std::string text;
  for (const auto& [key, value] : lines) text.append(key).append("=").append(value).append("\n");
  return text;
}

Result<RenderOptions> DecodeRenderOptions(const std::string& text) {
  if (text.size() > kTextSizeMax) return BadInput("the render options are too long");
  RenderOptions options;
  std::string_view rest = text;
  while (!rest.empty()) {
    const size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const size_t equals = line.find('=');
    if (equals == std::string_view::npos) return BadInput("render options: a line without \"=\"");
    const std::string_view key = line.substr(0, equals);
    if (!ReadOption(key, line.substr(equals + 1), &options)) {
      return BadInput("render options: \"" + std::string(line) + "\" is not understood" +
                      DidYouMean(key, kKeys));
    }
  }
  return options;
}

}  // namespace tessera
