// What the farm's render slots do, summed over time. Pure: the time is an argument.
#pragma once

#include <algorithm>

#include "coordinator/core/schedule/counters.h"
#include "coordinator/core/schedule/instant.h"

namespace tessera {

// Slots of one worker, or of all, by what they do now.
struct SlotUse {
  int leased = 0, fetching = 0, loading = 0, idle = 0;
  bool operator==(const SlotUse&) const = default;
};

// A change or a step of time costs a few additions, however many workers there are.
class Occupancy {
 public:
  // The slots of a worker did `from` and do `to` from now on.
  void Change(const SlotUse& from, const SlotUse& to) {
    const auto step = [](int& sum, int before, int after) { sum += after - before; };
    step(now_.leased, from.leased, to.leased);
    step(now_.fetching, from.fetching, to.fetching);
    step(now_.loading, from.loading, to.loading);
    step(now_.idle, from.idle, to.idle);
  }
  // Adds the time since the last call, during which the slots did what they did when it ended.
  void Advance(Instant now, FarmCounters& counters) {
    const double passed_s = begun_ && now > at_ ? Seconds(now - at_) : 0;
    counters.leased_s += passed_s * since_.leased;
    counters.fetching_s += passed_s * since_.fetching;
    counters.loading_s += passed_s * since_.loading;
    counters.idle_s += passed_s * since_.idle;
    counters.slot_s += passed_s * (since_.leased + since_.fetching + since_.loading + since_.idle);
    at_ = begun_ ? std::max(at_, now) : now;
    begun_ = true;
    since_ = now_;
  }
  // Slots by what they do now.
  const SlotUse& now() const { return now_; }
  // The moment of the last call of Advance.
  Instant at() const { return at_; }

 private:
  SlotUse now_, since_;
  Instant at_{};
  bool begun_ = false;
};

}  // namespace tessera
