// A stage of workers whose results are verified.
#pragma once

#include <string>
#include <vector>

#include "tests/coordinator/core/schedule/scheduler_stage.h"

namespace tessera {

// Workers that return results; the right result is "right".
struct VerifyingStage : SchedulerStage {
  explicit VerifyingStage(double share, SchedulerOptions options = {}) : SchedulerStage(options) {
    verify_share = share;
  }
  // Returns the result as the farm does; true if it is merged.
  bool Return(uint64_t worker, const Lease& lease, const std::string& result) {
    held[worker].erase(lease.id);
    if (scheduler.NeedsVote(lease.unit)) {
      last = scheduler.RecordVote(now, WorkerId{worker}, lease.id, lease.unit, 0.01, Sha256(result));
      if (last.kind != VoteOutcome::Kind::kAccepted) return false;
    }
    return scheduler.Finish(now, WorkerId{worker}, lease.id, lease.unit, 0.01);
  }
  void ReturnAll(uint64_t worker, const std::string& result) {
    for (const Lease& lease : Held(worker)) Return(worker, lease, result);
  }
  std::vector<WorkUnit> Units(uint64_t worker) {
    std::vector<WorkUnit> units;
    for (const Lease& lease : Held(worker)) units.push_back(lease.unit);
    return units;
  }
  VoteOutcome last;
};

}  // namespace tessera
