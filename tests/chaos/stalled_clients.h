// Clients of a coordinator that stop in the middle of a call: they neither read the pictures and the progress
// that they ask for nor send the rest of their files.
#pragma once

#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/chaos/lasting_fault.h"

namespace tessera {

class StalledClients : public LastingFault {
 public:
  struct Target {
    std::string address;
    uint64_t job = 0;  // with a picture
  };
  // Opens some calls of each kind. They stall for longer than a coordinator may wait, then the clients check
  // that it does not wait for them any more.
  void Open(Target target);
  // The digests of the files that are sent in part.
  static std::string Files();
  // How many strikes have not ended yet.
  int open() const;
  // How many calls were checked.
  int checked() const;
  void Tick() override {}
  // Ends the calls. Those that have not stalled for long enough are not checked.
  void End() override;
  std::vector<std::string> problems() const override;

 private:
  void Stall(const std::stop_token& stop, const Target& target);

  mutable std::mutex mutex_;
  // Guarded by mutex_.
  int open_ = 0, checked_ = 0;
  std::vector<std::string> problems_;
  std::vector<std::jthread> threads_;  // last: they use the others
};

}  // namespace tessera
