// Ctrl-C: the first cancels, the second ends the process at once.
#pragma once

#include <atomic>
#include <thread>

#include "client/cancellation.h"

namespace tessera {

// While it lives, SIGINT and SIGTERM cancel. Make it first of all in main: threads started before it would
// receive the signals in its place. Child processes inherit the blocked signals and have to unblock them.
class Interrupt {
 public:
  // `cancellation` must outlive this.
  explicit Interrupt(Cancellation& cancellation);
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

 private:
  void WaitForSignals();

  Cancellation& cancellation_;
  std::atomic<bool> closing_ = false;
  std::thread thread_;
};

}  // namespace tessera
