#include "renderer/description/number.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <system_error>

namespace tessera {
namespace {

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

// Of digits without sign and prefix.
std::optional<float> ParseHexadecimal(std::string_view digits) {
  uint64_t value = 0;
  const char* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, value, 16);
  if (error != std::errc() || stop != end || digits.empty()) return std::nullopt;
  return static_cast<float>(value);
}

// Of an unsigned decimal number that from_chars found to be beyond the normal range of a float.
std::optional<float> ParseTiny(std::string_view text) {
  double value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc()) return value < 1 ? std::optional(static_cast<float>(value)) : std::nullopt;
  // Beyond doubles too. Its exponent tells on which side; without one, leading zeros do.
  const size_t exponent = text.find_first_of("eE");
  if (exponent != std::string_view::npos && exponent + 1 < text.size()) {
    return text[exponent + 1] == '-' ? std::optional(0.0f) : std::nullopt;
  }
  return text[0] == '0' || text[0] == '.' ? std::optional(0.0f) : std::nullopt;
}

std::optional<float> ParseUnsigned(std::string_view text) {
  if (text.empty() || !(IsDigit(text[0]) || text[0] == '.'))
    return std::nullopt;  // keeps "inf" and "nan" out
  if (text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) {
    return ParseHexadecimal(text.substr(2));
  }
  float value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc::invalid_argument || stop != end) return std::nullopt;
  if (error == std::errc::result_out_of_range) return ParseTiny(text);
  return value;
}

}  // namespace

std::optional<float> ParseFloat(std::string_view text) {
  const bool negative = !text.empty() && text[0] == '-';
  if (negative || (!text.empty() && text[0] == '+')) text.remove_prefix(1);
  const std::optional<float> value = ParseUnsigned(text);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return negative ? -*value : *value;
}

std::optional<int> ParseInteger(std::string_view text) {
  if (!text.empty() && text[0] == '+') {
    text.remove_prefix(1);
    if (!text.empty() && text[0] == '-') return std::nullopt;
  }
  int value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

}  // namespace tessera
