// Grants, ends and returns leases, and keeps in agreement what depends on them: the samples that are open,
// the units that are verified, what workers are to be told, and which workers have room. Owned by the
// scheduler.
#pragma once

#include <limits>

#include "coordinator/core/schedule/schedule_state.h"

namespace tessera {

class LeaseControl {
 public:
  explicit LeaseControl(ScheduleState& state) : state_(state) {}

  // The samples must have been taken out of the open ones, or belong to a unit that is verified.
  LeaseRecord& Grant(Instant now, WorkerRecord& worker, Job& job, ActiveFrame& frame, const WorkUnit& unit,
                     LeaseId id);
  // The lease ends; its samples stay as they are. Returns its last state.
  LeaseRecord End(LeaseId id);
  // The lease ends and its samples are open again. A unit that is verified stays whole as long as another
  // worker has rendered it or holds it.
  void Return(LeaseId id);
  // Returns the lease and lists it in the next directive to its holder as one to drop.
  void Revoke(LeaseId id);
  // Ends a lease whose samples were merged from other results, and lists it as one to drop.
  void DropDone(LeaseId id);
  void ReturnAllOf(WorkerId worker);
  // All leases of a job or frame that ends.
  void RevokeAll(const std::vector<LeaseId>& leases);
  // Opens the samples again, as far as they are neither done nor held.
  void Reopen(const WorkUnit& unit, ActiveFrame& frame);

  // Whether the worker should get one more lease, as long as it has fewer than `per_slot_max` for each slot.
  bool HasRoom(const WorkerRecord& worker, int per_slot_max) const {
    return HasRoom(worker, state_.leases.QueueOf(worker.id), per_slot_max);
  }
  // Call after every change of what the worker holds or may do.
  void UpdateRoom(WorkerRecord& worker);

 private:
  static bool HasRoom(const WorkerRecord& worker, const LeaseTable::Queue& queue, int per_slot_max);
  // Counts at most `seconds_max`, and returns what it counted.
  double CountGivenUp(const LeaseRecord& record, double seconds_max = std::numeric_limits<double>::max());
  // Return after the lease has ended and its time is counted.
  void ReturnSamples(const LeaseRecord& record);

  ScheduleState& state_;
};

}  // namespace tessera
