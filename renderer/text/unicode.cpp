#include "renderer/text/unicode.h"

#include <utf8proc.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

namespace tessera {
namespace {

constexpr std::string_view kReplacement = "\xef\xbf\xbd";  // U+FFFD

// The code point at the start of `text`, which is not empty. Length 0: the first byte is not UTF-8.
struct CodePoint {
  utf8proc_int32_t value = -1;
  size_t length = 0;
};

CodePoint FirstOf(std::string_view text) {
  CodePoint point;
  const utf8proc_ssize_t length = utf8proc_iterate(reinterpret_cast<const utf8proc_uint8_t*>(text.data()),
                                                   static_cast<utf8proc_ssize_t>(text.size()), &point.value);
  if (length > 0) point.length = static_cast<size_t>(length);
  return point;
}

// Control characters, and the separators that some viewers break lines at.
bool IsControl(utf8proc_int32_t c) {
  return c < 0x20 || (c >= 0x7f && c <= 0x9f) || c == 0x2028 || c == 0x2029;
}

// The marks, embeddings, overrides and isolates of the bidirectional algorithm (UAX #9).
bool IsDirection(utf8proc_int32_t c) {
  return c == 0x061c || c == 0x200e || c == 0x200f || (c >= 0x202a && c <= 0x202e) ||
         (c >= 0x2066 && c <= 0x2069);
}

bool IsAscii(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

}  // namespace

bool IsUtf8(std::string_view text) {
  while (!text.empty()) {
    const CodePoint point = FirstOf(text);
    if (point.length == 0) return false;
    text.remove_prefix(point.length);
  }
  return true;
}

std::string Normalize(std::string_view text) {
  if (IsAscii(text)) return std::string(text);
  utf8proc_uint8_t* composed = nullptr;
  const auto options = static_cast<utf8proc_option_t>(UTF8PROC_STABLE | UTF8PROC_COMPOSE);
  const utf8proc_ssize_t length =
      utf8proc_map(reinterpret_cast<const utf8proc_uint8_t*>(text.data()),
                   static_cast<utf8proc_ssize_t>(text.size()), &composed, options);
  const std::unique_ptr<utf8proc_uint8_t, decltype(&std::free)> owner(composed, &std::free);
  if (length < 0) return std::string(text);
  return {reinterpret_cast<const char*>(composed), static_cast<size_t>(length)};
}

std::string CleanText(std::string_view text, size_t bytes_max) {
  std::string clean;
  while (!text.empty()) {
    const CodePoint point = FirstOf(text);
    std::string_view piece = text.substr(0, point.length);
    if (point.length == 0 || IsDirection(point.value)) {
      piece = kReplacement;
    } else if (IsControl(point.value)) {
      piece = " ";
    }
    if (clean.size() + piece.size() > bytes_max) break;
    clean += piece;
    text.remove_prefix(std::max<size_t>(point.length, 1));
  }
  return clean;
}

std::string LogText(std::string_view text) {
  std::string field = "\"";
  for (const char c : CleanText(text, kLogTextMax)) {
    if (c == '"' || c == '\\') field += '\\';
    field += c;
  }
  return field + '"';
}

}  // namespace tessera
