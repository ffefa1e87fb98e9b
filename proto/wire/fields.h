// Small checks of single fields, for the conversions of this box alone.
#pragma once

#include <set>
#include <string>

#include "proto/scene_package.h"
#include "proto/terms.h"
#include "renderer/util/result.h"

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

// The tags of a repeated field, each once.
template <typename Repeated>
Result<std::set<std::string>> ReadTags(const Repeated& words, const char* field) {
  if (static_cast<size_t>(words.size()) > kTagsMax) return BadField(field, "are too many");
  std::set<std::string> tags;
  for (const std::string& word : words) {
    if (!IsTag(word)) return BadField(field, "contain an invalid tag");
    tags.insert(word);
  }
  return tags;
}

}  // namespace tessera
