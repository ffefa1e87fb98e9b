// Where in a scene's files a thing was written.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "renderer/util/result.h"

namespace tessera {

struct SourceLocation {
  std::shared_ptr<const std::string> file;  // as the user or the scene named it
  int line = 1;                             // from 1
  int column = 1;                           // from 1, in bytes

  // "file:line:column"
  std::string Text() const;
};

// "file:line:column: message", as bad input; one line of valid UTF-8 whatever the message quotes from a file.
Error ErrorAt(const SourceLocation& where, const std::string& message);

// Text from a file between quotes, for messages: shortened if long.
std::string Quoted(std::string_view text);

}  // namespace tessera
