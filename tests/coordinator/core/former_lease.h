// Workers with leases of a former process of the coordinator.
#pragma once

#include "coordinator/core/farm.h"
#include "tests/coordinator/core/schedule/former_lease.h"

namespace tessera {

// The worker joins and lists the lease, which begins the unit's frame.
inline void JoinWithFormerLease(Farm& farm, Instant now, CallId call, WorkerId worker, const WorkUnit& unit) {
  WorkerState state;
  state.farm = farm.id();
  state.worker = worker;
  state.sequence = static_cast<uint64_t>(call);
  state.leases = {{FormerLease(), unit, LeaseStage::kRunning, {}}};
  farm.Synchronize(now, call, state);
}

}  // namespace tessera
