#include "renderer/pbrt/token_stream.h"

namespace tessera {

Token TokenStream::Next() {
  if (peeked_) {
    const Token token = *peeked_;
    peeked_.reset();
    return token;
  }
  while (true) {
    const Token token = lexers_.back()->Next();
    if (token.kind != Token::Kind::kEnd || lexers_.size() == 1) return token;
    lexers_.pop_back();
  }
}

const Token& TokenStream::Peek() {
  if (!peeked_) peeked_ = Next();
  return *peeked_;
}

}  // namespace tessera
