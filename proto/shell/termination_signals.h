// The signals that ask a program to end, as calls of a function.
#pragma once

#include <signal.h>

#include <atomic>
#include <functional>
#include <thread>

namespace tessera {

// As long as it lives, every SIGINT, SIGTERM or SIGQUIT calls `action` on a thread of its own, with the
// number of signals received so far. SIGHUP does so only if it is the first signal: a terminal that closes
// sends several, and systemd sends one after SIGTERM. SIGHUP and SIGQUIT stay ignored if they are, as under
// nohup. Create it before any other thread: threads that are already running would receive the signals
// instead. Child processes inherit the blocked signals and have to unblock them.
class TerminationSignals {
 public:
  explicit TerminationSignals(std::function<void(int count)> action);
  ~TerminationSignals();
  TerminationSignals(const TerminationSignals&) = delete;
  TerminationSignals& operator=(const TerminationSignals&) = delete;

 private:
  void WaitForSignals();

  const sigset_t signals_;
  std::function<void(int count)> action_;
  std::atomic<bool> closing_ = false;
  std::thread thread_;
};

}  // namespace tessera
