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

// Writes an entry of the audit log, "audit " and the text, as a line of level info where log lines go. The
// level of StartLog does not hide it: who changed what is recorded however little else is wanted.
void WriteAuditEntry(const std::string& text);

}  // namespace tessera
