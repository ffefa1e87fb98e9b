#include "proto/shell/rare_log.h"

#include <spdlog/spdlog.h>

namespace tessera {

void RareLog::Warn(const std::string& event, const std::string& detail) {
  const std::lock_guard lock(mutex_);
  ++count_;
  const auto now = std::chrono::steady_clock::now();
  if (now >= due_) {
    due_ = now + interval_;
    left_ = burst_;
  }
  if (left_ == 0) return;
  --left_;
  spdlog::warn("{} count={} {}", event, count_, detail);
  count_ = 0;
}

}  // namespace tessera
