// What people and monitoring systems see of a farm at one moment, as values.
#pragma once

#include <string>
#include <vector>

#include "coordinator/core/farm.h"
#include "coordinator/core/schedule/occupancy.h"

namespace tessera {

// Bytes transferred since the coordinator started.
struct Traffic {
  uint64_t results_in = 0;  // radiance
  uint64_t blobs_in = 0, blobs_out = 0;
};

// Results being returned now.
struct IntakeUse {
  uint64_t bytes = 0;    // admitted and not yet on disk
  uint64_t waiting = 0;  // calls that wait for room
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
  uint64_t blob_bytes = 0;                 // kept on disk
  uint64_t disk_free = 0, disk_total = 0;  // bytes of the disk with the data directory; 0: not known
  std::string storage_reason;  // why the journal or the spool cannot be written; empty if they can
};

}  // namespace tessera
