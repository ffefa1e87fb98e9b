// What the terminal of a command can show.
#pragma once

#include <string>
#include <string_view>

namespace tessera {

struct TerminalSize {
  int columns = 80, rows = 24;
};
// The size of the terminal behind a descriptor; 80 x 24 if it is none or does not know.
TerminalSize TerminalSizeOf(int descriptor);

// The text up to its first `columns` characters, so that it does not wrap. Each character of UTF-8 counts as
// one column. Escape sequences must not be in it.
std::string FirstColumns(std::string_view text, int columns);

}  // namespace tessera
