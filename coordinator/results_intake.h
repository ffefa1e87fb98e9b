// How many bytes of results are in memory at once, from the moment they are read off the network until they
// are on disk and answered. Whoever finds no room waits in line, first come first served, and what he sends
// meanwhile stays in his own memory. So neither a thousand workers nor a disk that refuses can fill memory.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>

#include "coordinator/core/farm.h"

namespace tessera {

// Room for a second of what a coordinator merges on two cores. What is let in is held encoded and decoded for
// a moment, so memory may be a few times that.
constexpr uint64_t kIntakeBytesMax = uint64_t{128} << 20;

// Thread safe. No lock is held while `admitted` is called.
class ResultsIntake {
 public:
  explicit ResultsIntake(uint64_t bytes_max) : bytes_max_(bytes_max) {}

  // Calls `admitted` when there is room for that many bytes: immediately, or later from another thread.
  // More than all the room there is are admitted alone.
  void Enter(CallId call, uint64_t bytes, std::function<void()> admitted);
  // Gives the room of an admitted call to others.
  void Leave(uint64_t bytes);
  // Takes a call out of the line. False if it does not stand there: it is admitted, or was never there.
  bool Withdraw(CallId call);

  uint64_t bytes() const;
  size_t waiting() const;

 private:
  struct Place {
    CallId call{};
    uint64_t bytes = 0;
    std::function<void()> admitted;
  };
  bool HasRoom(uint64_t bytes) const { return bytes_ == 0 || bytes_ + bytes <= bytes_max_; }
  void AdmitWhoFits();

  const uint64_t bytes_max_;
  mutable std::mutex mutex_;  // of what follows
  uint64_t bytes_ = 0;        // of admitted calls
  std::deque<Place> line_;
};

}  // namespace tessera
