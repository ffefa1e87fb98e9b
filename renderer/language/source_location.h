// Where in a scene's files a thing was written.
#pragma once

#include <memory>
#include <string>

#include <fmt/format.h>

#include "util/result.h"

namespace tessera {

struct SourceLocation {
  std::shared_ptr<const std::string> file;  // as the user or the scene named it
  int line = 1;                             // from 1
  int column = 1;                           // from 1, in bytes

  std::string Text() const { return fmt::format("{}:{}:{}", file ? *file : "<scene>", line, column); }
};

// "file:line:column: message", as bad input.
inline Error ErrorAt(const SourceLocation& where, const std::string& message) {
  return BadInput(where.Text() + ": " + message);
}

}  // namespace tessera
