#include "renderer/description/number.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tessera {
namespace {

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

// The exponent that stands after "e" or "E", at most so large that sums with the length of a text do not
// overflow; 0 if there is none.
int64_t WrittenExponent(std::string_view text) {
  constexpr int64_t kLarge = int64_t{1} << 60;
  const size_t mark = text.find_first_of("eE");
  if (mark == std::string_view::npos || mark + 1 == text.size()) return 0;
  int64_t exponent = 0;
  const auto read = ReadNumber(text.data() + mark + 1, text.data() + text.size(), exponent);
  const bool is_negative = text[mark + 1] == '-';
  if (read.ec == std::errc::result_out_of_range) return is_negative ? -kLarge : kLarge;
  return std::clamp(exponent, -kLarge, kLarge);
}

// Whether a decimal number beyond the range of its type is too small rather than too large: the power of ten
// of its first digit other than 0 decides.
bool IsTiny(std::string_view text) {
  const std::string_view mantissa = text.substr(0, text.find_first_of("eE"));
  const size_t first = mantissa.find_first_of("123456789");
  if (first == std::string_view::npos) return true;
  const size_t point = std::min(mantissa.find('.'), mantissa.size());
  const int64_t power = static_cast<int64_t>(point) - static_cast<int64_t>(first);
  return power + WrittenExponent(text) <= 0;
}

// What a number beyond the range of its type becomes. A float may still be denormal.
void ReadBeyondRange(std::string_view text, double& value) {
  value = IsTiny(text) ? 0 : std::numeric_limits<double>::infinity();
  if (text.starts_with('-')) value = -value;
}
void ReadBeyondRange(std::string_view text, float& value) {
  double wide = 0;
  ReadNumber(text.data(), text.data() + text.size(), wide);
  value = static_cast<float>(wide);
}

template <typename Float>
std::from_chars_result ReadFloating(const char* first, const char* last, Float& value) {
  const bool has_plus = last - first > 1 && first[0] == '+' && first[1] != '-';
  const char* const start = has_plus ? first + 1 : first;
  std::from_chars_result read = std::from_chars(start, last, value);
  if (read.ec == std::errc::result_out_of_range) {
    ReadBeyondRange({start, static_cast<size_t>(read.ptr - start)}, value);
    read.ec = std::errc();
  }
  return read;
}

// Of digits without sign and prefix.
std::optional<float> ParseHexadecimal(std::string_view digits) {
  uint64_t value = 0;
  const char* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, value, 16);
  if (error != std::errc() || stop != end || digits.empty()) return std::nullopt;
  return static_cast<float>(value);
}

}  // namespace

std::from_chars_result ReadNumber(const char* first, const char* last, float& value) {
  return ReadFloating(first, last, value);
}
std::from_chars_result ReadNumber(const char* first, const char* last, double& value) {
  return ReadFloating(first, last, value);
}

std::optional<float> ParseFloat(std::string_view text) {
  const bool has_sign = !text.empty() && (text[0] == '-' || text[0] == '+');
  const std::string_view digits = text.substr(has_sign ? 1 : 0);
  // Keeps "inf" and "nan" out.
  if (digits.empty() || !(IsDigit(digits[0]) || digits[0] == '.')) return std::nullopt;
  const bool is_hexadecimal = digits.size() > 2 && digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X');
  const std::optional<float> value =
      is_hexadecimal ? ParseHexadecimal(digits.substr(2)) : ParseNumber<float>(digits);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return text[0] == '-' ? -*value : *value;
}

std::optional<int> ParseInteger(std::string_view text) {
  return ParseNumber<int>(text);
}

}  // namespace tessera
