#include "renderer/scene/light_group_rule.h"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/description/source_location.h"

namespace tessera {
namespace {

bool IsNameByte(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

bool IsControl(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

}  // namespace

Result<void> CheckLightGroupName(std::string_view name) {
  if (name.empty() || name.size() > kLightGroupNameMax || !std::ranges::all_of(name, IsNameByte)) {
    return BadInput(
        fmt::format("{} cannot be the name of a light group, expected 1 to {} letters, digits, \"_\" and "
                    "\"-\", which names of "
                    "layers may have",
                    Quoted(name), kLightGroupNameMax));
  }
  return {};
}

Result<LightGroupRule> ParseLightGroupRule(std::string_view text) {
  const size_t equals = text.find('=');
  if (equals == std::string_view::npos) return BadInput(fmt::format("{} is not NAME=PATTERN", Quoted(text)));
  LightGroupRule rule{std::string(text.substr(0, equals)), std::string(text.substr(equals + 1))};
  if (auto named = CheckLightGroupName(rule.group); !named) return named.error();
  if (rule.pattern.empty() || rule.pattern.size() > kLightGroupPatternMax ||
      std::ranges::any_of(rule.pattern, IsControl)) {
    return BadInput(
        fmt::format("the pattern of light group \"{}\" is empty, longer than {} bytes or holds control "
                    "characters",
                    rule.group, kLightGroupPatternMax));
  }
  return rule;
}

bool MatchesPattern(std::string_view pattern, std::string_view text) {
  // Where to go on if what follows the last star does not match: with one byte more for the star.
  size_t p = 0, t = 0, star = std::string_view::npos, star_text = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      star_text = t;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++star_text;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

}  // namespace tessera
