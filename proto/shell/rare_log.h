// Log lines about events that a peer can cause as often as it likes.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

namespace tessera {

// Writes the first events of an interval immediately and counts the others, so that an attack cannot fill the
// disk of the log. Thread safe.
class RareLog {
 public:
  // `burst`: the events that are written in an interval.
  explicit RareLog(std::chrono::milliseconds interval, int burst = 1) : interval_(interval), burst_(burst) {}
  // Logs "EVENT count=N DETAIL" as a warning. N includes the events since the last line.
  void Warn(const std::string& event, const std::string& detail);
  // The same for lines that are written elsewhere: returns N, or nullopt if this event is only counted.
  std::optional<uint64_t> Count();

 private:
  const std::chrono::milliseconds interval_;
  const int burst_;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point due_{};  // guarded by mutex_
  int left_ = 0;                                 // of the burst; guarded by mutex_
  uint64_t count_ = 0;                           // guarded by mutex_
};

}  // namespace tessera
