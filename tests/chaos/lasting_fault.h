// A fault that is injected in a moment and lasts for a while.
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace tessera {

using Clock = std::chrono::steady_clock;

class LastingFault {
 public:
  virtual ~LastingFault() = default;
  // Ends what is due. Called often, from the thread that injects the faults.
  virtual void Tick() = 0;
  // Ends all of it.
  virtual void End() = 0;
  // What the farm did that it must not do under this fault. Complete after End.
  virtual std::vector<std::string> problems() const { return {}; }
};

}  // namespace tessera
