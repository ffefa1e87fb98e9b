// Simulated time: events happen in order of their time, events of the same time in the order they were
// planned.
#pragma once

#include <functional>
#include <map>
#include <utility>

#include "coordinator/core/schedule/instant.h"

namespace tessera {

class EventQueue {
 public:
  Instant now() const { return now_; }
  void After(Instant delay, std::function<void()> event) {
    events_.emplace(std::pair(now_ + delay, planned_++), std::move(event));
  }
  bool empty() const { return events_.empty(); }
  Instant next_at() const { return events_.begin()->first.first; }
  void RunNext() {
    auto event = events_.extract(events_.begin());
    now_ = event.key().first;
    event.mapped()();
  }

 private:
  Instant now_{};
  uint64_t planned_ = 0;
  std::map<std::pair<Instant, uint64_t>, std::function<void()>> events_;
};

}  // namespace tessera
