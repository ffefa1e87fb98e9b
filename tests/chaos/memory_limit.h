// What a machine or its control group does to a worker that takes too much memory: kills it.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

namespace tessera {

class MemoryLimit {
 public:
  // Kills the workers among the children of this process, which its main thread started, that have more than
  // `bytes` resident.
  explicit MemoryLimit(uint64_t bytes);
  int kills() const { return kills_; }

 private:
  void KillLarge(uint64_t bytes);

  std::atomic<int> kills_ = 0;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace tessera
