// SIGINT and SIGTERM as calls of a function.
#pragma once

#include <atomic>
#include <functional>
#include <thread>

namespace tessera {

// As long as it lives, every SIGINT or SIGTERM calls `action` on a thread of its own, with the number of
// signals received so far. Create it before any other thread: threads that are already running would receive
// the signals instead. Child processes inherit the blocked signals and have to unblock them.
class TerminationSignals {
 public:
  explicit TerminationSignals(std::function<void(int count)> action);
  ~TerminationSignals();
  TerminationSignals(const TerminationSignals&) = delete;
  TerminationSignals& operator=(const TerminationSignals&) = delete;

 private:
  void WaitForSignals();

  std::function<void(int count)> action_;
  std::atomic<bool> closing_ = false;
  std::thread thread_;
};

}  // namespace tessera
