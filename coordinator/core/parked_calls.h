// Calls of workers that wait for news, at most one of each worker. Pure bookkeeping. Owned by the farm.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <utility>

#include "coordinator/core/farm_output.h"
#include "coordinator/core/schedule/instant.h"

namespace tessera {

class ParkedCalls {
 public:
  // The worker's call waits until `until`. Returns the call that waited before it, if there was one.
  std::optional<CallId> Park(WorkerId worker, CallId call, Instant until) {
    const std::optional<CallId> older = Take(worker);
    calls_[worker] = {call, until};
    workers_[call] = worker;
    due_.emplace(until, worker);
    return older;
  }
  // The worker's call does not wait any more. Returns nullopt if none does.
  std::optional<CallId> Take(WorkerId worker) {
    const auto found = calls_.find(worker);
    if (found == calls_.end()) return std::nullopt;
    const auto [call, until] = found->second;
    workers_.erase(call);
    due_.erase({until, worker});
    calls_.erase(found);
    return call;
  }
  bool Has(WorkerId worker) const { return calls_.contains(worker); }
  std::optional<WorkerId> WorkerOf(CallId call) const {
    const auto found = workers_.find(call);
    return found == workers_.end() ? std::nullopt : std::optional(found->second);
  }
  // The worker whose call has waited until `now`, if there is one.
  std::optional<WorkerId> FirstDue(Instant now) const {
    if (due_.empty() || due_.begin()->first > now) return std::nullopt;
    return due_.begin()->second;
  }
  // When the first call has waited long enough; nullopt if none waits.
  std::optional<Instant> next_due() const {
    return due_.empty() ? std::nullopt : std::optional(due_.begin()->first);
  }

 private:
  std::map<WorkerId, std::pair<CallId, Instant>> calls_;
  std::map<CallId, WorkerId> workers_;
  std::set<std::pair<Instant, WorkerId>> due_;
};

}  // namespace tessera
