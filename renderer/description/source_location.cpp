#include "renderer/description/source_location.h"

#include <fmt/format.h>

namespace tessera {
namespace {

constexpr size_t kQuotedLengthMax = 60;  // bytes: enough to recognise the place, short enough for one line

bool IsContinuation(char c) {
  return (static_cast<unsigned char>(c) & 0xc0) == 0x80;
}

// Length of the well-formed UTF-8 sequence that `text` starts with; 0 if there is none. Table 3-7 of the
// Unicode standard: no overlong forms, no surrogates, nothing above U+10FFFF.
size_t SequenceLength(std::string_view text) {
  const unsigned char first = static_cast<unsigned char>(text[0]);
  if (first < 0x80) return 1;
  const size_t length = first >= 0xc2 && first <= 0xdf   ? 2
                        : first >= 0xe0 && first <= 0xef ? 3
                        : first >= 0xf0 && first <= 0xf4 ? 4
                                                         : 0;
  if (length == 0 || text.size() < length) return 0;
  for (size_t i = 1; i < length; ++i) {
    if (!IsContinuation(text[i])) return 0;
  }
  const unsigned char second = static_cast<unsigned char>(text[1]);
  if (first == 0xe0 && second < 0xa0) return 0;
  if (first == 0xed && second > 0x9f) return 0;
  if (first == 0xf0 && second < 0x90) return 0;
  if (first == 0xf4 && second > 0x8f) return 0;
  return length;
}

}  // namespace

std::string SourceLocation::Text() const {
  return fmt::format("{}:{}:{}", file ? *file : "<scene>", line, column);
}

Error ErrorAt(const SourceLocation& where, const std::string& message) {
  return BadInput(OneLine(where.Text() + ": " + message));
}

std::string Quoted(std::string_view text) {
  if (text.size() <= kQuotedLengthMax) return fmt::format("\"{}\"", text);
  size_t length = kQuotedLengthMax;
  while (length > 0 && IsContinuation(text[length])) --length;
  return fmt::format("\"{}...\"", text.substr(0, length));
}

std::string OneLine(std::string_view text) {
  std::string line;
  line.reserve(text.size());
  while (!text.empty()) {
    const size_t length = SequenceLength(text);
    const unsigned char first = static_cast<unsigned char>(text[0]);
    if (length == 0 || first < 0x20 || first == 0x7f) {
      line += '?';
    } else {
      line += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return line;
}

}  // namespace tessera
