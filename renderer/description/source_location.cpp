#include "renderer/description/source_location.h"

#include <fmt/format.h>

#include "renderer/util/text.h"

namespace tessera {
namespace {

constexpr size_t kQuotedLengthMax = 60;  // bytes: enough to recognise the place, short enough for one line

bool IsContinuation(char c) {
  return (static_cast<unsigned char>(c) & 0xc0) == 0x80;
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

}  // namespace tessera
