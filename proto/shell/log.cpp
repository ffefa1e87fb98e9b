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

}  // namespace tessera
