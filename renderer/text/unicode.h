// Text from outside: names, reasons and messages of users, scenes and other machines. Independent of locales.
#pragma once

#include <string>
#include <string_view>

namespace tessera {

// Whether the bytes are valid UTF-8.
bool IsUtf8(std::string_view text);

// The text in normalisation form C: composed and decomposed spellings of a character become the same bytes.
// Bytes that are not UTF-8 are returned unchanged.
std::string Normalize(std::string_view text);

// Makes any bytes safe to store, send, log and show: one line of valid UTF-8 of at most `bytes_max` bytes,
// cut between code points. Control characters (C0, DEL, C1) and line and paragraph separators become spaces.
// Each byte that is not UTF-8 and each character that changes the direction of writing becomes U+FFFD.
// Idempotent.
std::string CleanText(std::string_view text, size_t bytes_max);

// The text, cleaned, in quotes, with \ before quotes and backslashes: a field of a log line that no text can
// end early. At most kLogTextMax bytes are kept.
std::string LogText(std::string_view text);
inline constexpr size_t kLogTextMax = 4096;  // as long as the longest reason of a failure

}  // namespace tessera
