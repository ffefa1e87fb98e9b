#include "proto/shell/termination_signals.h"

#include <pthread.h>
#include <signal.h>

#include "renderer/util/check.h"

namespace tessera {
namespace {

sigset_t TheSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

}  // namespace

TerminationSignals::TerminationSignals(std::function<void(int count)> action) : action_(std::move(action)) {
  const sigset_t signals = TheSignals();
  TESSERA_CHECK(pthread_sigmask(SIG_BLOCK, &signals, nullptr) == 0);
  thread_ = std::thread([this] { WaitForSignals(); });
}

TerminationSignals::~TerminationSignals() {
  closing_ = true;
  // The signal is blocked in that thread and ends its wait, not the process.
  // NOLINTNEXTLINE(bugprone-bad-signal-to-kill-thread)
  pthread_kill(thread_.native_handle(), SIGTERM);
  thread_.join();
}

void TerminationSignals::WaitForSignals() {
  const sigset_t signals = TheSignals();
  for (int count = 0;;) {
    int signal = 0;
    if (sigwait(&signals, &signal) != 0) continue;
    if (closing_) return;
    action_(++count);
  }
}

}  // namespace tessera
