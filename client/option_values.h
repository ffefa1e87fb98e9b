// Turns the words of the command line into values. Every function refuses what is beyond the limits with a
// message that names the flag, the word and what was expected.
#pragma once

#include <array>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "proto/shell/values.h"
#include "renderer/film/frame_spec.h"
#include "renderer/util/result.h"

namespace tessera {

// "WxH", pixels.
Result<std::pair<int, int>> ParseResolution(std::string_view word);
// "x0,x1,y0,y1", fractions of the picture.
Result<std::array<float, 4>> ParseCrop(std::string_view word);
// "half" or "float".
Result<ExrType> ParseExrType(std::string_view word);
// "P%", 0 to 100, as a share of 1; the sign may be missing.
Result<double> ParsePercent(std::string_view flag, std::string_view word);
// Names out of `known`, separated by commas.
Result<std::set<std::string>> ParseNames(std::string_view flag, std::string_view word,
                                         std::span<const std::string_view> known);

}  // namespace tessera
