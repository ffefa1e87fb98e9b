#include "client/commands/option_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <vector>

namespace tessera {
namespace {

template <typename Number>
bool ParseWhole(std::string_view word, Number& number) {
  const char* end = word.data() + word.size();
  const auto parsed = std::from_chars(word.data(), end, number);
  return parsed.ec == std::errc() && parsed.ptr == end;
}

std::vector<std::string_view> Split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  size_t begin = 0;
  for (size_t end = text.find(separator); end != std::string_view::npos; end = text.find(separator, begin)) {
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  parts.push_back(text.substr(begin));
  return parts;
}

}  // namespace

Result<std::pair<int, int>> ParseResolution(std::string_view flag, std::string_view word) {
  const auto sides = Split(word, 'x');
  int width = 0, height = 0;
  if (sides.size() != 2 || !ParseWhole(sides[0], width) || !ParseWhole(sides[1], height) || width < 1 ||
      height < 1 || width > kResolutionMax || height > kResolutionMax) {
    return BadInput(
        fmt::format("{}: \"{}\" is not WxH with sides of 1 to {} pixels", flag, word, kResolutionMax));
  }
  return std::pair(width, height);
}

Result<std::array<float, 4>> ParseCrop(std::string_view flag, std::string_view word) {
  const auto parts = Split(word, ',');
  std::array<float, 4> crop{};
  bool good = parts.size() == 4;
  for (size_t i = 0; good && i < 4; ++i) good = ParseWhole(parts[i], crop[i]) && crop[i] >= 0 && crop[i] <= 1;
  if (!good || crop[0] >= crop[1] || crop[2] >= crop[3]) {
    return BadInput(fmt::format("{}: \"{}\" is not x0,x1,y0,y1 with 0 <= x0 < x1 <= 1 and 0 <= y0 < y1 <= 1",
                                flag, word));
  }
  return crop;
}

Result<std::array<int, 4>> ParsePixelBounds(std::string_view flag, std::string_view word) {
  const auto parts = Split(word, ',');
  std::array<int, 4> bounds{};
  bool good = parts.size() == 4;
  for (size_t i = 0; good && i < 4; ++i)
    good = ParseWhole(parts[i], bounds[i]) && bounds[i] >= 0 && bounds[i] <= kResolutionMax;
  if (!good || bounds[0] >= bounds[1] || bounds[2] >= bounds[3]) {
    return BadInput(
        fmt::format("{0}: \"{1}\" is not x0,x1,y0,y1 with 0 <= x0 < x1 <= {2} and 0 <= y0 < y1 <= {2}", flag,
                    word, kResolutionMax));
  }
  return bounds;
}

Result<ExrType> ParseExrType(std::string_view flag, std::string_view word) {
  if (word == "half") return ExrType::kHalf;
  if (word == "float") return ExrType::kFloat;
  return BadInput(fmt::format("{}: \"{}\" is neither half nor float", flag, word));
}

Result<Denoiser> ParseDenoiser(std::string_view flag, std::string_view word) {
  const auto names = std::span(kDenoiserNames).subspan(1);  // without "none"
  const auto name = ParseChoice(flag, word, names);
  if (!name) return name.error();
  return static_cast<Denoiser>(std::ranges::find(kDenoiserNames, *name) - std::begin(kDenoiserNames));
}

Result<ExrCompression> ParseCompression(std::string_view flag, std::string_view word) {
  const auto name = ParseChoice(flag, word, ExrCompressionNames());
  if (!name) return name.error();
  return *ExrCompressionOf(*name);
}

Result<ExrLayout> ParseExrLayout(std::string_view flag, std::string_view word) {
  if (word == "scanlines") return ExrLayout::kScanLines;
  if (word == "tiles") return ExrLayout::kTiles;
  return BadInput(fmt::format("{}: \"{}\" is neither scanlines nor tiles", flag, word));
}

Result<double> ParsePercent(std::string_view flag, std::string_view word) {
  const std::string_view digits = word.ends_with('%') ? word.substr(0, word.size() - 1) : word;
  double percent = 0;
  if (!ParseWhole(digits, percent) || !(percent >= 0 && percent <= 100)) {
    return BadInput(fmt::format("{}: \"{}\" is not a percentage from 0% to 100%", flag, word));
  }
  return percent / 100;
}

Result<std::set<std::string>> ParseNames(std::string_view flag, std::string_view word,
                                         std::span<const std::string_view> known) {
  std::set<std::string> names;
  for (std::string_view name : Split(word, ',')) {
    auto chosen = ParseChoice(flag, name, known);
    if (!chosen) return chosen.error();
    names.insert(std::move(*chosen));
  }
  return names;
}

}  // namespace tessera
