// Small helpers for messages to people.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tessera {

// The candidate with the smallest edit distance to `word`, if it is near enough to be a likely misspelling;
// otherwise an empty string.
std::string NearestWord(std::string_view word, std::span<const std::string_view> candidates);

// " (pbrt-v4 calls it \"x\")" for a word of pbrt-v3, " (did you mean \"x\"?)" for the nearest candidate, or
// "".
std::string DidYouMean(std::string_view word, std::span<const std::string_view> candidates);

// `text` with control characters and bytes that are not UTF-8 replaced by '?'.
std::string OneLine(std::string_view text);

}  // namespace tessera
