// The log of a program: lines of "event key=value ..." on stderr.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tessera {

constexpr const char* kLogLevelDefault = "info";

// From the most to the least detailed.
std::span<const std::string_view> LogLevels();

// Makes spdlog's default logger write lines of at least `level`, one of LogLevels(), to stderr: time with UTC
// offset, level, text. Call it once.
void StartLog(const std::string& level);

}  // namespace tessera
