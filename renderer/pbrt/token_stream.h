// The tokens of a scene file with those of the files it includes in their places.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "renderer/pbrt/lexer.h"

namespace tessera {

class TokenStream {
 public:
  explicit TokenStream(std::unique_ptr<Lexer> lexer) { lexers_.push_back(std::move(lexer)); }

  // Continues with the tokens of `lexer`, then with the rest of the current file. Not between Peek and Next.
  void Push(std::unique_ptr<Lexer> lexer) { lexers_.push_back(std::move(lexer)); }

  // kEnd only at the end of the first file. A token's text is valid until the next call of Next or Peek.
  Token Next();
  const Token& Peek();

  // How many files are open: 1 without an Include.
  int depth() const { return static_cast<int>(lexers_.size()); }

 private:
  std::vector<std::unique_ptr<Lexer>> lexers_;  // never empty; the last one is being read
  std::optional<Token> peeked_;
};

}  // namespace tessera
