// What people and monitoring systems see of a farm: one look at everything, as values.
#pragma once

#include <optional>
#include <vector>

#include "coordinator/core/farm.h"
#include "coordinator/core/schedule/occupancy.h"

namespace tessera {

class CoreThread;

// Bytes that went through the coordinator since it started.
struct Traffic {
  uint64_t results_in = 0;  // radiance
  uint64_t blobs_in = 0, blobs_out = 0;
};

// Of returned results, now.
struct IntakeUse {
  uint64_t bytes = 0;    // let in and not yet on disk
  uint64_t waiting = 0;  // calls, for room
};

struct FarmView {
  std::vector<JobStatus> jobs;  // oldest first
  std::vector<WorkerStatus> workers;
  FarmCounters counters;
  SlotUse slots;
  size_t leases = 0;
  uint64_t samples_left = 0;  // pixel samples of open jobs that are not merged
  Traffic traffic;
  IntakeUse intake;
  uint64_t blob_bytes = 0;  // kept on disk
};

// Asks the core thread; nothing if it does not answer in time. `traffic`, `intake` and `blob_bytes` are
// the caller's to fill in.
std::optional<FarmView> LookAtFarm(CoreThread& core);

}  // namespace tessera
