#include "proto/shell/rare_log.h"

#include <spdlog/spdlog.h>

#include <utility>

namespace tessera {

void RareLog::Warn(const std::string& event, const std::string& detail) {
  if (const auto count = Count()) spdlog::warn("{} count={} {}", event, *count, detail);
}

std::optional<uint64_t> RareLog::Count() {
  const std::lock_guard lock(mutex_);
  ++count_;
  const auto now = std::chrono::steady_clock::now();
  if (now >= due_) {
    due_ = now + interval_;
    left_ = burst_;
  }
  if (left_ == 0) return std::nullopt;
  --left_;
  return std::exchange(count_, 0);
}

}  // namespace tessera
