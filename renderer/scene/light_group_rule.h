// --light-group NAME=PATTERN.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "renderer/util/result.h"

namespace tessera {

// Each is a layer of three channels, of which a frame has at most 256.
constexpr size_t kLightGroupsMax = 64;
constexpr size_t kLightGroupNameMax = 64;      // bytes
constexpr size_t kLightGroupPatternMax = 256;  // bytes

// Lights that match the pattern (MatchesPattern) are in the group.
struct LightGroupRule {
  std::string group, pattern;
  bool operator==(const LightGroupRule&) const = default;
};

// Whether compositors can group channels under this name: letters, digits, "_" and "-".
Result<void> CheckLightGroupName(std::string_view name);
// "NAME=PATTERN".
Result<LightGroupRule> ParseLightGroupRule(std::string_view text);
// Whether `text` matches: "*" stands for any text, "?" for one byte.
bool MatchesPattern(std::string_view pattern, std::string_view text);

}  // namespace tessera
