#include "proto/shell/termination_signals.h"

#include <pthread.h>
#include <signal.h>

#include "renderer/util/check.h"

namespace tessera {
namespace {

bool IsIgnored(int signal) {
  struct sigaction action {};
  return ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

sigset_t HandledSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  for (const int signal : {SIGHUP, SIGQUIT}) {
    if (!IsIgnored(signal)) sigaddset(&signals, signal);
  }
  return signals;
}

}  // namespace

TerminationSignals::TerminationSignals(std::function<void(int count)> action)
    : signals_(HandledSignals()), action_(std::move(action)) {
  TESSERA_CHECK(pthread_sigmask(SIG_BLOCK, &signals_, nullptr) == 0);
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
  for (int count = 0;;) {
    int signal = 0;
    if (sigwait(&signals_, &signal) != 0) continue;
    if (closing_) return;
    if (signal != SIGHUP || count == 0) action_(++count);
  }
}

}  // namespace tessera
