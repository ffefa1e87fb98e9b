// Cuts the text of one scene file into tokens.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "renderer/description/source_location.h"

namespace tessera {

constexpr size_t kStringLengthMax = 1 << 16;  // bytes of a quoted string: longer than any path or name

struct Token {
  enum class Kind {
    kEnd,     // of the file
    kWord,    // a directive, number, true, false, ...
    kString,  // was quoted
    kOpen,    // [
    kClose,   // ]
    kBad,     // no token: `text` says why
  };
  Kind kind = Kind::kEnd;
  // A string without its quotes, with its escapes resolved. Points into the lexer: valid until the next
  // token.
  std::string_view text;
  int line = 1, column = 1;                                  // of its first byte
  const std::shared_ptr<const std::string>* file = nullptr;  // of the lexer

  SourceLocation Location() const { return {file ? *file : nullptr, line, column}; }
};

// Tokens are separated by blanks, tabs and line ends; brackets and quotes also end a word; "#" at the start
// of a token begins a comment that lasts to the end of the line.
class Lexer {
 public:
  // `file` names the text in messages.
  Lexer(std::string text, std::shared_ptr<const std::string> file);
  Lexer(const Lexer&) = delete;
  Lexer& operator=(const Lexer&) = delete;

  // After kEnd or kBad, returns the same again.
  Token Next();

 private:
  void SkipBlanksAndComments();
  Token Make(Token::Kind kind, const char* start, std::string_view text) const;
  Token Bad(const char* start, std::string_view why);
  Token String();
  // The string from `start` (its first byte after the quote) to `stop`, escapes resolved.
  Token Unescaped(const char* start, const char* stop);

  std::string text_;
  std::shared_ptr<const std::string> file_;
  const char* position_;
  const char* end_;
  const char* line_start_;
  int64_t line_ = 1;
  std::string unescaped_;
};

}  // namespace tessera
