// The leases that a worker holds, and at which stage each is. A pure state machine: time comes in as an
// argument.
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "proto/terms.h"

namespace tessera {

// Not thread safe.
class LeaseBook {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  // Set by the book when the unit is not wanted any more, read by the thread that renders it.
  using StopFlag = std::shared_ptr<std::atomic<bool>>;
  struct Started {
    Lease lease;
    StopFlag stop;
  };

  // A lease that is or was here is ignored: messages may be repeated. Whether it is new.
  bool Add(const Lease& lease, TimePoint now);
  // Starts the first waiting lease whose scene `is_ready`.
  std::optional<Started> Start(const std::function<bool(const Digest& scene)>& is_ready, TimePoint now);
  // Rendered; false if it was dropped meanwhile, so that nobody wants the result.
  bool Finish(LeaseId id, TimePoint now);
  // Its result or failure is acknowledged, or it is not wanted; stops its rendering.
  void Forget(LeaseId id);
  // Forgets and gives the leases that have not been started.
  std::vector<LeaseId> TakeWaiting();
  // Forgets, stops and gives the leases that are being rendered.
  std::vector<LeaseId> TakeRunning();
  // Forgets all leases of a scene that cannot be had, and gives those that are not yet rendered.
  std::vector<LeaseId> TakeScene(const Digest& scene);
  bool Holds(LeaseId id) const;
  bool Uses(const Digest& scene) const;
  size_t running() const;
  // For the next Synchronize.
  std::vector<HeldLease> Held(TimePoint now) const;
  // The shortest of the durations of the leases held; nothing if there are none.
  std::optional<std::chrono::milliseconds> ShortestDuration() const;

 private:
  struct Entry {
    Lease lease;
    LeaseStage stage = LeaseStage::kWaiting;
    TimePoint since;
    StopFlag stop;
  };
  std::vector<LeaseId> Take(const std::function<bool(const Entry&)>& which);
  std::list<Entry>::iterator Find(LeaseId id);
  void Bury(LeaseId id);

  std::list<Entry> entries_;  // in order of arrival: the order in which to render
  std::set<LeaseId> past_;    // of the last kPastMax leases gone
  std::deque<LeaseId> past_order_;
};

}  // namespace tessera
