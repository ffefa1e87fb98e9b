#include "client/interrupt.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

namespace tessera {
namespace {

sigset_t EndingSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

}  // namespace

Interrupt::Interrupt(Cancellation& cancellation) : cancellation_(cancellation) {
  const sigset_t signals = EndingSignals();
  TESSERA_CHECK(pthread_sigmask(SIG_BLOCK, &signals, nullptr) == 0);
  thread_ = std::thread([this] { WaitForSignals(); });
}

Interrupt::~Interrupt() {
  closing_ = true;
  pthread_kill(thread_.native_handle(), SIGTERM);
  thread_.join();
}

void Interrupt::WaitForSignals() {
  const sigset_t signals = EndingSignals();
  for (int count = 0;;) {
    int signal = 0;
    if (sigwait(&signals, &signal) != 0) continue;
    if (closing_) return;
    if (++count > 1)
      _exit(static_cast<int>(ErrorKind::kInterrupted));  // the kernel ends our children with us
    cancellation_.Cancel({ErrorKind::kInterrupted, "interrupted"});
  }
}

}  // namespace tessera
