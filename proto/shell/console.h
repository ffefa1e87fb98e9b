// What programs print for people, on stderr.
#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace tessera {

// Writes the text to stderr. Ignores errors: a terminal that was closed or a pipe without a reader must not
// end what the program does. Thread safe.
void WriteToConsole(std::string_view text);

// Formats a message and writes it to stderr.
template <typename... Args>
void PrintNote(fmt::format_string<Args...> format, Args&&... args) {
  WriteToConsole(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace tessera
