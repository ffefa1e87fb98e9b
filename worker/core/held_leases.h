// The leases that a worker holds and the stage of each. A pure state machine: time is passed in.
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
class HeldLeases {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  // Set when the unit is not wanted any more, read by the thread that renders it.
  using StopFlag = std::shared_ptr<std::atomic<bool>>;
  struct Started {
    Lease lease;
    StopFlag stop;
  };

  // Ignores a lease that is or was here, since messages may be repeated. Returns whether it is new.
  bool Add(const Lease& lease, TimePoint now);
  // Starts the first waiting lease whose scene `is_ready`.
  std::optional<Started> Start(const std::function<bool(const Digest& scene)>& is_ready, TimePoint now);
  // The unit is rendered. Returns false if it was dropped meanwhile, so its result is not wanted.
  bool Finish(LeaseId id, TimePoint now);
  // The result or failure is acknowledged, or the unit is not wanted. Stops its rendering.
  void Forget(LeaseId id);
  // Forgets every lease that is or was here, and stops those that are being rendered.
  void Clear();
  // Forgets and returns the leases that have not been started.
  std::vector<LeaseId> TakeWaiting();
  // Forgets, stops and returns the leases that are being rendered.
  std::vector<LeaseId> TakeRunning();
  // Forgets and returns the leases of a scene that cannot be loaded, except those already rendered.
  std::vector<LeaseId> TakeScene(const Digest& scene);
  bool Holds(LeaseId id) const;
  bool Uses(const Digest& scene) const;
  size_t running() const;
  // For the next Synchronize.
  std::vector<HeldLease> Held(TimePoint now) const;
  // The shortest duration of the leases held; nullopt if there are none.
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
  void Remember(LeaseId id);

  std::list<Entry> entries_;  // in order of arrival, which is the order of rendering
  std::set<LeaseId> past_;    // the last kPastMax leases forgotten
  std::deque<LeaseId> past_order_;
};

}  // namespace tessera
