// Turns words of a command line into values. Every function refuses what is malformed or out of range with a
// message that names the flag, the word and what was expected.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "renderer/util/result.h"

namespace tessera {

Result<int64_t> ParseInteger(std::string_view flag, std::string_view word, int64_t min, int64_t max);
Result<uint64_t> ParseUnsigned(std::string_view flag, std::string_view word, uint64_t min = 0,
                               uint64_t max = std::numeric_limits<uint64_t>::max());
// A finite number that is at least `min` and at most `max`.
Result<double> ParseNumber(std::string_view flag, std::string_view word, double min,
                           double max = std::numeric_limits<double>::infinity());
// A number of bytes: "500M", "1.5G", "20GB". The units K, M, G and T are powers of 1024; "B" or "iB" may
// follow them, and case does not matter. A fraction of a byte is dropped.
Result<uint64_t> ParseSize(std::string_view flag, std::string_view word, uint64_t min = 0);
// The shortest exact form that ParseSize reads: "20G", "1536M", "0".
std::string SizeText(uint64_t bytes);
// A worker's tag (IsTag).
Result<std::string> ParseTag(std::string_view flag, std::string_view word);
// One of `choices`.
Result<std::string> ParseChoice(std::string_view flag, std::string_view word,
                                std::span<const std::string_view> choices);

}  // namespace tessera
