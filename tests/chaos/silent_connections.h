// Connections to a coordinator that say nothing, more than it may have descriptors.
#pragma once

#include <string>
#include <vector>

#include "tests/chaos/lasting_fault.h"

namespace tessera {

class SilentConnections : public LastingFault {
 public:
  ~SilentConnections() override { End(); }
  // Opens connections to an address, HOST:PORT of this machine or unix:PATH, until the farm accepts no more
  // or there are `count`. Those that were open before are closed.
  void Open(const std::string& address, int count, Clock::duration duration);
  bool is_open() const { return !sockets_.empty(); }
  void Tick() override;
  void End() override;

 private:
  std::vector<int> sockets_;
  Clock::time_point until_;
};

}  // namespace tessera
