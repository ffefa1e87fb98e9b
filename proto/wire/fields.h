// Small checks of single fields, for the conversions of this box alone.
#pragma once

#include <string>

#include "terms/scene_package.h"
#include "util/result.h"

namespace tessera {

inline Error BadField(const std::string& field, const std::string& what) {
  return BadInput("message refused: " + field + " " + what);
}

// Whether the bytes are one line of text within the limit.
inline bool IsText(const std::string& text, size_t bytes_max) {
  if (text.size() > bytes_max) return false;
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return false;
  }
  return true;
}

}  // namespace tessera
