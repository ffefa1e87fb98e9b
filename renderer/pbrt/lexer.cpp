#include "renderer/pbrt/lexer.h"

#include <algorithm>
#include <limits>

#include "renderer/text/unicode.h"

namespace tessera {
namespace {

bool IsBlank(char c) {
  return c == ' ' || c == '\n' || c == '\t' || c == '\r';
}
bool EndsWord(char c) {
  return IsBlank(c) || c == '"' || c == '[' || c == ']';
}
int ToInt(int64_t v) {
  return static_cast<int>(std::min<int64_t>(v, std::numeric_limits<int>::max()));
}

constexpr std::string_view kUtf8Mark = "\xef\xbb\xbf";

// What "\c" stands for; 0 if nothing.
char Escape(char c) {
  switch (c) {
    case 'b': return '\b';
    case 'f': return '\f';
    case 'n': return '\n';
    case 'r': return '\r';
    case 't': return '\t';
    case '\\':
    case '\'':
    case '"': return c;
    default: return 0;
  }
}

}  // namespace

Lexer::Lexer(std::string text, std::shared_ptr<const std::string> file)
    : text_(std::move(text)), file_(std::move(file)) {
  position_ = text_.data();
  end_ = position_ + text_.size();
  if (text_.starts_with(kUtf8Mark)) position_ += kUtf8Mark.size();
  line_start_ = position_;
}

Token Lexer::Make(Token::Kind kind, const char* start, std::string_view text) const {
  return {kind, text, ToInt(line_), ToInt(start - line_start_ + 1), &file_};
}

Token Lexer::Bad(const char* start, std::string_view why) {
  position_ = start;  // so that the next call finds the same
  return Make(Token::Kind::kBad, start, why);
}

void Lexer::SkipBlanksAndComments() {
  while (position_ < end_) {
    const char c = *position_;
    if (c == '#') {
      while (position_ < end_ && *position_ != '\n' && *position_ != '\r') ++position_;
    } else if (c == '\n') {
      line_start_ = ++position_;
      ++line_;
    } else if (IsBlank(c)) {
      ++position_;
    } else {
      return;
    }
  }
}

Token Lexer::Next() {
  if (position_ == text_.data() && (text_.starts_with("\xfe\xff") || text_.starts_with("\xff\xfe"))) {
    return Bad(position_, "the file is UTF-16, expected UTF-8");
  }
  SkipBlanksAndComments();
  if (position_ == end_) return Make(Token::Kind::kEnd, position_, {});
  const char* start = position_;
  switch (*start) {
    case '[': ++position_; return Make(Token::Kind::kOpen, start, {start, 1});
    case ']': ++position_; return Make(Token::Kind::kClose, start, {start, 1});
    case '"': return String();
    default: break;
  }
  while (position_ < end_ && !EndsWord(*position_)) {
    if (*position_ == '\0') return Bad(start, "zero byte, expected text: is this a scene file?");
    ++position_;
  }
  return Make(Token::Kind::kWord, start, {start, static_cast<size_t>(position_ - start)});
}

Token Lexer::String() {
  const char* quote = position_;
  const char* start = quote + 1;
  const char* p = start;
  bool escaped = false;
  while (p < end_ && *p != '"' && *p != '\n') {
    if (*p == '\0') return Bad(quote, "zero byte in a string");
    if (*p == '\\') {
      escaped = true;
      ++p;
      if (p == end_ || *p == '\n') break;
    }
    ++p;
  }
  if (p >= end_ || *p == '\n')
    return Bad(quote, "unterminated string, expected '\"' before the end of the line");
  const std::string_view raw(start, static_cast<size_t>(p - start));
  if (raw.size() > kStringLengthMax) return Bad(quote, "string longer than 65536 bytes");
  if (!IsUtf8(raw)) return Bad(quote, "string that is not UTF-8");
  if (escaped) return Unescaped(start, p);
  position_ = p + 1;
  return Make(Token::Kind::kString, quote, raw);
}

Token Lexer::Unescaped(const char* start, const char* stop) {
  unescaped_.clear();
  for (const char* p = start; p < stop; ++p) {
    if (*p != '\\') {
      unescaped_ += *p;
      continue;
    }
    const char c = Escape(*++p);
    if (c == 0)
      return Bad(start - 1, "unknown escape in a string, expected \\b \\f \\n \\r \\t \\\\ \\' or \\\"");
    unescaped_ += c;
  }
  position_ = stop + 1;
  return Make(Token::Kind::kString, start - 1, unescaped_);
}

}  // namespace tessera
