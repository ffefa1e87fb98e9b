// Turns words of the command line into values of rendering (proto/shell/values.h has the common ones). Each
// function refuses a word that is malformed or out of range, with an error that names the flag, quotes the
// word and states what is expected.
#pragma once

#include <array>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "proto/shell/flags.h"
#include "proto/shell/values.h"
#include "renderer/film/frame_spec.h"
#include "renderer/film/picture_format.h"
#include "renderer/util/result.h"

namespace tessera {

// "WxH", pixels.
Result<std::pair<int, int>> ParseResolution(std::string_view flag, std::string_view word);
// "x0,x1,y0,y1", fractions of the picture.
Result<std::array<float, 4>> ParseCrop(std::string_view flag, std::string_view word);
// "x0,x1,y0,y1", pixels.
Result<std::array<int, 4>> ParsePixelBounds(std::string_view flag, std::string_view word);
// "half" or "float".
Result<ExrType> ParseExrType(std::string_view flag, std::string_view word);
Result<Denoiser> ParseDenoiser(std::string_view flag, std::string_view word);
Result<ExrCompression> ParseCompression(std::string_view flag, std::string_view word);
Result<ExrLayout> ParseExrLayout(std::string_view flag, std::string_view word);
// "P%", from 0 to 100, as a fraction of 1. The percent sign may be left out.
Result<double> ParsePercent(std::string_view flag, std::string_view word);
// Names out of `known`, separated by commas.
Result<std::set<std::string>> ParseNames(std::string_view flag, std::string_view word,
                                         std::span<const std::string_view> known);

// A reader of whole numbers from `min` to `max`.
template <typename Integer>
auto WholeNumber(Integer min, Integer max = std::numeric_limits<Integer>::max()) {
  return [min, max](std::string_view flag, std::string_view word) -> Result<Integer> {
    if constexpr (std::is_signed_v<Integer>) {
      const auto number = ParseInteger(flag, word, min, max);
      if (!number) return number.error();
      return static_cast<Integer>(*number);
    } else {
      const auto number = ParseUnsigned(flag, word, min, max);
      if (!number) return number.error();
      return static_cast<Integer>(*number);
    }
  };
}

// Adds a flag or argument (proto/shell/flags.h). Its word is read by `read`, a function of flag and word such
// as those above, and stored in `target`.
template <typename Target, typename Read>
void AddValue(CLI::App& app, const std::string& name, const std::string& type, const std::string& help,
              Target& target, Read read, Presence presence = Presence::kOptional) {
  const auto set = [name, &target, read](const std::string& word) -> Result<void> {
    auto value = read(name, word);
    if (!value) return value.error();
    target = std::move(value).value();
    return {};
  };
  AddWord(app, name, type, help, set, presence);
}

}  // namespace tessera
