// Numbers as scenes and their side files write them: independent of the locale, rounded correctly.
#pragma once

#include <optional>
#include <string_view>

namespace tessera {

// A decimal number with optional sign, point and exponent ("1.", ".5", "+3", "1e5") or a hexadecimal integer
// ("0x1f"). Returns nullopt for anything else, for "inf" and "nan", and for numbers too large for a float.
// Numbers too small become zero.
std::optional<float> ParseFloat(std::string_view text);

// A decimal integer of 32 bits with optional sign.
std::optional<int> ParseInteger(std::string_view text);

}  // namespace tessera
