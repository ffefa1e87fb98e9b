// Numbers as scenes and their side files write them: independent of the locale, rounded correctly. All text
// from outside becomes numbers here.
#pragma once

#include <charconv>
#include <concepts>
#include <optional>
#include <string_view>
#include <system_error>

namespace tessera {

// Reads the decimal number at the start of [first, last) as std::from_chars does, but also after a "+", and a
// number too small for its type as zero and one too large as infinity, both with their sign and without an
// error. "inf" and "nan" are numbers.
std::from_chars_result ReadNumber(const char* first, const char* last, float& value);
std::from_chars_result ReadNumber(const char* first, const char* last, double& value);
// The same for integers; one that its type cannot hold is an error.
template <std::integral Integer>
std::from_chars_result ReadNumber(const char* first, const char* last, Integer& value) {
  const bool has_plus = last - first > 1 && first[0] == '+' && first[1] != '-';
  return std::from_chars(has_plus ? first + 1 : first, last, value);
}

// Returns nullopt unless all of `text` is one number.
template <typename Number>
std::optional<Number> ParseNumber(std::string_view text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const std::from_chars_result read = ReadNumber(text.data(), end, value);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return value;
}

// A decimal number with optional sign, point and exponent ("1.", ".5", "+3", "1e5") or a hexadecimal integer
// ("0x1f"). Returns nullopt for anything else, for "inf" and "nan", and for numbers too large for a float.
// Numbers too small become zero.
std::optional<float> ParseFloat(std::string_view text);

// A decimal integer of 32 bits with optional sign.
std::optional<int> ParseInteger(std::string_view text);

}  // namespace tessera
