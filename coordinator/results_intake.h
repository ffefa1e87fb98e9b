// Bounds the bytes of results in memory, from the moment they are read from the network until they are on
// disk and acknowledged. Calls that find no room wait in a queue; their results stay in the memory of the
// worker. So neither a thousand workers nor a disk that refuses writes can fill the coordinator's memory.
//
// A call has its room before its results arrive, so a sender that announces results and does not send them
// must not keep it. The queue is first come first served between senders that have nothing in the room;
// other calls of a sender come after them, and those of senders that kept room for nothing come last.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/farm.h"

namespace tessera {

// What a coordinator merges in about a second on two cores.
constexpr uint64_t kIntakeBytesMax = uint64_t{128} << 20;
// Announced results that have not arrived after this time lose their room if other calls wait. Long enough
// for 128 MB to arrive over a network of 34 Mbit/s.
constexpr std::chrono::seconds kArrivalPatience{30};
// The same for a sender with another call in the room. Workers return results in one call at a time.
constexpr std::chrono::seconds kSecondArrivalPatience{1};

// Thread safe. No lock is held while a callback is called.
class ResultsIntake {
 public:
  using Clock = std::chrono::steady_clock;
  explicit ResultsIntake(uint64_t bytes_max) : bytes_max_(bytes_max) {}

  struct Call {
    CallId id{};
    std::string sender;
    uint64_t bytes = 0;
    std::function<void()> admitted;
    // Cancels an admitted call, which then leaves. Not called once its results have arrived.
    std::function<void()> expired;
  };
  // Calls `admitted` as soon as there is room: before it returns, or later from another thread. A call larger
  // than the whole room is admitted when nothing else is.
  void Enter(Call call);
  // The results of an admitted call are in memory.
  void Arrived(CallId call);
  // Reduces the room of an admitted call.
  void Shrink(CallId call, uint64_t bytes);
  // Releases the room of an admitted call.
  void Leave(CallId call);
  // Removes a call from the queue. Returns false if it is not waiting: it has been admitted or never entered.
  bool Withdraw(CallId call);
  // Takes room back from calls whose results do not arrive. Call it a few times a second.
  void Expire(Clock::time_point now);

  uint64_t bytes() const;
  size_t waiting() const;

 private:
  struct Admitted {
    std::string sender;
    uint64_t bytes = 0;
    bool has_arrived = false;
    bool is_expired = false;
    Clock::time_point since{};
    std::function<void()> expired;
  };
  bool HasRoom(uint64_t bytes) const { return bytes_ == 0 || bytes_ + bytes <= bytes_max_; }
  std::deque<Call>::iterator Next();
  void AdmitWaiting();

  const uint64_t bytes_max_;
  mutable std::mutex mutex_;  // of the members below
  uint64_t bytes_ = 0;        // of admitted calls
  std::deque<Call> queue_;
  std::map<CallId, Admitted> admitted_;
  std::map<std::string, int> calls_of_;  // admitted, by sender
  std::set<std::string> lapsed_;         // senders whose last results did not arrive
};

}  // namespace tessera
