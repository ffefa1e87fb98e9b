// Secrets that are given out and come back, such as cookies.
#pragma once

#include <string>
#include <string_view>

#include "renderer/util/digest.h"

namespace tessera {

// 256 random bits of the operating system, as 64 hexadecimal digits.
std::string RandomSecret();

// Compares in a time that depends on the sizes alone.
bool AreEqualSecrets(std::string_view a, std::string_view b);

// HMAC-SHA-256 of the text: nobody without the key can make it.
Digest KeyedDigest(std::string_view key, std::string_view text);

// The bytes in base64, with padding.
std::string Base64(std::string_view bytes);

}  // namespace tessera
