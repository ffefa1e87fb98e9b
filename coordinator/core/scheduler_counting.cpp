// What the scheduler's decisions come to, in numbers for people.
#include <algorithm>

#include "coordinator/core/scheduler.h"

namespace tessera {

// Keeps the farm's occupancy in step with this worker.
void Scheduler::CountSlots(WorkerRecord& worker) {
  SlotUse use;
  if (worker.live) {
    use.leased = std::min(worker.slots, static_cast<int>(worker.leases.size()));
    const int rest = worker.slots - use.leased;
    (worker.fetching ? use.fetching : worker.IsLoading() ? use.loading : use.idle) = rest;
  }
  occupancy_.Change(worker.use, use);
  worker.use = use;
}

// The lease is about to end without a result: what its holder did on it, as far as one can guess, was in
// vain.
void Scheduler::CountGivenUp(const LeaseRecord& record) {
  const double seconds = Seconds(occupancy_.at() - record.expected_start);
  if (seconds <= 0) return;
  counters_.waste_s += seconds;
  given_up_.push_back({record.lease.unit.job, seconds});
}

void Scheduler::CountAccepted(WorkerId worker, uint64_t pixel_samples, double render_seconds) {
  ++counters_.units_accepted;
  counters_.samples_accepted += pixel_samples;
  counters_.render_s += render_seconds;
  if (WorkerRecord* const record = FindWorker(worker)) record->pace.Accept(pixel_samples);
}

std::vector<Scheduler::GivenUp> Scheduler::TakeGivenUp() {
  return std::exchange(given_up_, {});
}

Scheduler::Phase Scheduler::PhaseOf(JobId id) const {
  const auto job = jobs_.find(id);
  if (job == jobs_.end() || (job->second.frames.empty() && job->second.frames_ahead.empty()))
    return Phase::kRendered;
  return job->second.HasOpen() ? Phase::kOpen : Phase::kTail;
}

}  // namespace tessera
