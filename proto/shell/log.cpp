#include "proto/shell/log.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace tessera {

std::span<const std::string_view> LogLevels() {
  static constexpr std::string_view kLevels[] = {"debug", "info", "warning", "error"};
  return kLevels;
}

void StartLog(const std::string& level) {
  auto logger = spdlog::stderr_logger_mt("tessera");
  logger->set_pattern("%Y-%m-%dT%H:%M:%S.%e%z %l %v");
  logger->set_level(spdlog::level::from_str(level));
  spdlog::set_default_logger(std::move(logger));
}

void WriteAuditEntry(const std::string& text) {
  const auto log = spdlog::default_logger();
  const std::string line = "audit " + text;  // the entry only refers to it
  const spdlog::details::log_msg entry(log->name(), spdlog::level::info, line);
  for (const auto& sink : log->sinks()) {
    sink->log(entry);
    sink->flush();
  }
}

}  // namespace tessera
