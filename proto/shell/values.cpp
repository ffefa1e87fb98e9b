#include "proto/shell/values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

#include "proto/terms.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr std::string_view kSizeUnits = "KMGT";
constexpr int kSizeUnitBits = 10;

template <typename Number>
bool ParseWhole(std::string_view word, Number& number) {
  const char* end = word.data() + word.size();
  const auto parsed = std::from_chars(word.data(), end, number);
  return parsed.ec == std::errc() && parsed.ptr == end;
}

template <typename Number>
Result<Number> ParseBounded(std::string_view flag, std::string_view word, Number min, Number max) {
  Number number{};
  if (!ParseWhole(word, number) || number < min || number > max) {
    return BadInput(fmt::format("{}: \"{}\" is not a whole number from {} to {}", flag, word, min, max));
  }
  return number;
}

// The power of two that a unit stands for; nullopt if it is not a unit.
std::optional<int> UnitBits(std::string_view unit) {
  std::string upper;
  for (const char c : unit) upper += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  if (upper.empty() || upper == "B") return 0;
  const size_t power = kSizeUnits.find(upper[0]);
  const std::string_view rest = std::string_view(upper).substr(1);
  if (power == std::string_view::npos || !(rest.empty() || rest == "B" || rest == "IB")) return std::nullopt;
  return kSizeUnitBits * (static_cast<int>(power) + 1);
}

// `digits` times 2^bits; nullopt if that is malformed, negative or too large.
std::optional<uint64_t> ScaledBytes(std::string_view digits, int bits) {
  if (digits.find('.') == std::string_view::npos) {
    uint64_t whole = 0;
    if (!ParseWhole(digits, whole) || whole > (UINT64_MAX >> bits)) return std::nullopt;
    return whole << bits;
  }
  double number = 0;
  if (!ParseWhole(digits, number)) return std::nullopt;
  const double bytes = std::ldexp(number, bits);
  if (!(bytes >= 0 && bytes < std::ldexp(1.0, 64))) return std::nullopt;
  return static_cast<uint64_t>(bytes);
}

}  // namespace

Result<int64_t> ParseInteger(std::string_view flag, std::string_view word, int64_t min, int64_t max) {
  return ParseBounded<int64_t>(flag, word, min, max);
}

Result<uint64_t> ParseUnsigned(std::string_view flag, std::string_view word, uint64_t min, uint64_t max) {
  return ParseBounded<uint64_t>(flag, word, min, max);
}

Result<double> ParseNumber(std::string_view flag, std::string_view word, double min, double max) {
  double number = 0;
  if (!ParseWhole(word, number) || !std::isfinite(number) || number < min || number > max) {
    const std::string bound =
        std::isfinite(max) ? fmt::format("from {} to {}", min, max) : fmt::format("of at least {}", min);
    return BadInput(fmt::format("{}: \"{}\" is not a number {}", flag, word, bound));
  }
  return number;
}

Result<uint64_t> ParseSize(std::string_view flag, std::string_view word, uint64_t min) {
  const size_t end = std::min(word.find_first_not_of("0123456789."), word.size());
  const auto bits = UnitBits(word.substr(end));
  const auto bytes = bits ? ScaledBytes(word.substr(0, end), *bits) : std::nullopt;
  if (!bytes) return BadInput(fmt::format("{}: \"{}\" is not a size such as 500M, 1.5G or 20G", flag, word));
  if (*bytes < min) return BadInput(fmt::format("{}: \"{}\" is less than {}", flag, word, SizeText(min)));
  return *bytes;
}

std::string SizeText(uint64_t bytes) {
  size_t power = 0;
  while (bytes != 0 && power < kSizeUnits.size() && bytes % (uint64_t{1} << kSizeUnitBits) == 0) {
    bytes >>= kSizeUnitBits;
    ++power;
  }
  return fmt::format("{}{}", bytes, power > 0 ? kSizeUnits.substr(power - 1, 1) : "");
}

Result<std::string> ParseTag(std::string_view flag, std::string_view word) {
  if (IsTag(word)) return std::string(word);
  return BadInput(
      fmt::format("{}: \"{}\" is not a word of letters, digits and . _ - + : of at most {} characters", flag,
                  word, kTagBytesMax));
}

Result<std::string> ParseChoice(std::string_view flag, std::string_view word,
                                std::span<const std::string_view> choices) {
  for (const std::string_view choice : choices) {
    if (word == choice) return std::string(word);
  }
  return BadInput(fmt::format("{}: \"{}\" is not one of {}{}", flag, word, fmt::join(choices, ", "),
                              DidYouMean(word, choices)));
}

}  // namespace tessera
