// SIGINT and SIGTERM as calls of a function.
#pragma once

#include <atomic>
#include <functional>
#include <thread>

namespace tessera {

// While it lives, every SIGINT or SIGTERM calls `action` on a thread of its own, with the count of signals so
// far. Make it first of all in main: threads started before it would receive the signals in its place. Child
// processes inherit the blocked signals and have to unblock them.
class EndingSignals {
 public:
  explicit EndingSignals(std::function<void(int count)> action);
  ~EndingSignals();
  EndingSignals(const EndingSignals&) = delete;
  EndingSignals& operator=(const EndingSignals&) = delete;

 private:
  void WaitForSignals();

  std::function<void(int count)> action_;
  std::atomic<bool> closing_ = false;
  std::thread thread_;
};

}  // namespace tessera
