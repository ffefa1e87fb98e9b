#include "renderer/util/ending_signals.h"

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

EndingSignals::EndingSignals(std::function<void(int count)> action) : action_(std::move(action)) {
  const sigset_t signals = TheSignals();
  TESSERA_CHECK(pthread_sigmask(SIG_BLOCK, &signals, nullptr) == 0);
  thread_ = std::thread([this] { WaitForSignals(); });
}

EndingSignals::~EndingSignals() {
  closing_ = true;
  // NOLINTNEXTLINE(bugprone-bad-signal-to-kill-thread): it is blocked there and ends a wait, not the process.
  pthread_kill(thread_.native_handle(), SIGTERM);
  thread_.join();
}

void EndingSignals::WaitForSignals() {
  const sigset_t signals = TheSignals();
  for (int count = 0;;) {
    int signal = 0;
    if (sigwait(&signals, &signal) != 0) continue;
    if (closing_) return;
    action_(++count);
  }
}

}  // namespace tessera
