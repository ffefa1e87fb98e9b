// Bounds the bytes of results in memory, from the moment they are read from the network until they are on
// disk and acknowledged. Calls that find no room wait in a queue, first come first served; their results stay
// in the memory of the worker. So neither a thousand workers nor a disk that refuses writes can fill the
// coordinator's memory.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>

#include "coordinator/core/farm.h"

namespace tessera {

// What a coordinator merges in about a second on two cores. Admitted results are held encoded and decoded for
// a moment, so the memory used may be a few times that.
constexpr uint64_t kIntakeBytesMax = uint64_t{128} << 20;

// Thread safe. No lock is held while `admitted` is called.
class ResultsIntake {
 public:
  explicit ResultsIntake(uint64_t bytes_max) : bytes_max_(bytes_max) {}

  // Calls `admitted` as soon as there is room for `bytes`: before it returns, or later from another thread. A
  // call larger than the whole room is admitted when nothing else is.
  void Enter(CallId call, uint64_t bytes, std::function<void()> admitted);
  // Releases the room of an admitted call.
  void Leave(uint64_t bytes);
  // Removes a call from the queue. Returns false if it is not waiting: it has been admitted or never entered.
  bool Withdraw(CallId call);

  uint64_t bytes() const;
  size_t waiting() const;

 private:
  struct Waiting {
    CallId call{};
    uint64_t bytes = 0;
    std::function<void()> admitted;
  };
  bool HasRoom(uint64_t bytes) const { return bytes_ == 0 || bytes_ + bytes <= bytes_max_; }
  void AdmitWaiting();

  const uint64_t bytes_max_;
  mutable std::mutex mutex_;  // of the members below
  uint64_t bytes_ = 0;        // of admitted calls
  std::deque<Waiting> queue_;
};

}  // namespace tessera
