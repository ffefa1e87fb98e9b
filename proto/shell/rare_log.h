// Log lines about events that a peer can cause as often as it likes.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

namespace tessera {

// Writes the first event immediately and counts the others of an interval, so that an attack cannot fill the
// disk of the log. Thread safe.
class RareLog {
 public:
  explicit RareLog(std::chrono::milliseconds interval) : interval_(interval) {}
  // Logs "EVENT count=N DETAIL" as a warning. N includes the events since the last line.
  void Warn(const std::string& event, const std::string& detail);

 private:
  const std::chrono::milliseconds interval_;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point due_{};  // guarded by mutex_
  uint64_t count_ = 0;                           // guarded by mutex_
};

}  // namespace tessera
