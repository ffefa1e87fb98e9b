// The bytes of the page's files, as embed.cmake writes them into a source when this program is built.
#pragma once

#include <cstddef>
#include <span>

namespace tessera {

struct EmbeddedFile {
  const char* name;
  const unsigned char* bytes;
  size_t size;
};

std::span<const EmbeddedFile> EmbeddedFiles();

}  // namespace tessera
