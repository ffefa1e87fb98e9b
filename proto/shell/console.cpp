#include "proto/shell/console.h"

#include <cstdio>

namespace tessera {

void WriteToConsole(std::string_view text) {
  [[maybe_unused]] const size_t written = std::fwrite(text.data(), 1, text.size(), stderr);
  [[maybe_unused]] const int flushed = std::fflush(stderr);
}

}  // namespace tessera
