#include "coordinator/core/schedule/lease_control.h"

#include <algorithm>

#include "coordinator/core/schedule/policy.h"

namespace tessera {

LeaseRecord& LeaseControl::Grant(Instant now, WorkerRecord& worker, Job& job, ActiveFrame& frame,
                                 const WorkUnit& unit, LeaseId id) {
  constexpr auto kDuration = std::chrono::duration_cast<std::chrono::milliseconds>(kLeaseDuration);
  const PixelBounds bounds = job.spec->frames[unit.frame].spec.TileBounds(static_cast<int>(unit.tile));
  LeaseRecord& record = state_.leases.Add(now, {worker.id, worker.slots, worker.speed},
                                          {id, unit, bounds, frame.work.Pixels(unit.tile), kDuration},
                                          frame.work.Cost({unit.tile, unit.range}));
  state_.workers.Announce(worker, id);
  ++state_.counters.leases_granted;
  frame.verification.Hold({unit.tile, unit.range}, {worker.id, worker.machine});
  UpdateRoom(worker);
  return record;
}

LeaseRecord LeaseControl::End(LeaseId id) {
  LeaseRecord record = state_.leases.Remove(id);
  const WorkUnit& unit = record.lease.unit;
  WorkerRecord& worker = state_.workers.At(record.worker);
  std::erase(worker.pending.leases, id);
  ActiveFrame& frame = state_.jobs.At(unit.job).schedule.active.at(unit.frame);
  frame.verification.Release({unit.tile, unit.range}, worker.id);
  if (state_.losses.TrialOf(worker.id)) state_.idle.Remove(worker.id);  // it waits for the end of its leases
  // A worker without units may have a frame begun beyond the limits.
  if (state_.jobs.has_refused() && state_.leases.OfWorker(worker.id).empty()) state_.idle.Remove(worker.id);
  UpdateRoom(worker);
  return record;
}

void LeaseControl::Return(LeaseId id) {
  const LeaseRecord record = End(id);
  CountGivenUp(record);
  ReturnSamples(record);
}

void LeaseControl::ReturnSamples(const LeaseRecord& record) {
  const WorkUnit& unit = record.lease.unit;
  ++state_.counters.leases_retried;
  state_.idle.UnblockAll();
  ActiveFrame& frame = state_.jobs.At(unit.job).schedule.active.at(unit.frame);
  const TileSamples samples{unit.tile, unit.range};
  if (frame.verification.IsVerifying(samples) && !frame.verification.Abandon(samples)) return;
  Reopen(unit, frame);
}

void LeaseControl::Revoke(LeaseId id) {
  state_.workers.Revoke(state_.workers.At(state_.leases.At(id).worker), id);
  Return(id);
}

void LeaseControl::DropDone(LeaseId id) {
  const LeaseRecord& record = state_.leases.At(id);
  ++state_.counters.leases_moot;
  CountGivenUp(record);
  state_.workers.Drop(state_.workers.At(record.worker), id);
  End(id);
}

// Units that waited would have started on the slots that others took: together they took no more than those.
void LeaseControl::ReturnAllOf(WorkerId worker) {
  const std::vector<LeaseId> leases = state_.leases.OfWorker(worker);
  const Instant now = state_.workers.occupancy().at();
  Instant begun = now;
  for (const LeaseId lease : leases) begun = std::min(begun, state_.leases.At(lease).expected_start);
  double left_s = state_.workers.At(worker).slots * Seconds(now - begun);
  for (const LeaseId lease : leases) {
    const LeaseRecord record = End(lease);
    left_s -= CountGivenUp(record, left_s);
    ReturnSamples(record);
  }
}

void LeaseControl::RevokeAll(const std::vector<LeaseId>& leases) {
  for (const LeaseId lease : leases) {
    const LeaseRecord& record = state_.leases.At(lease);
    CountGivenUp(record);
    state_.workers.Revoke(state_.workers.At(record.worker), lease);
    End(lease);
  }
}

void LeaseControl::Reopen(const WorkUnit& unit, ActiveFrame& frame) {
  std::vector<SampleRange> held = frame.verification.UnitsOf(unit.tile);
  for (const auto& [lease, range] : state_.leases.OfTile(unit)) held.push_back(range);
  frame.work.GiveBack({unit.tile, unit.range}, held);
}

bool LeaseControl::HasRoom(const WorkerRecord& worker, const LeaseTable::Queue& queue, int per_slot_max) {
  const int held = static_cast<int>(queue.leases.size());
  if (held >= worker.slots * per_slot_max) return false;
  return held < worker.slots * kUnitsPerSlotMin ||
         queue.Seconds(worker.speed) < worker.slots * kPrefetchDuration_s;
}

void LeaseControl::UpdateRoom(WorkerRecord& worker) {
  const LeaseTable::Queue& queue = state_.leases.QueueOf(worker.id);
  state_.workers.UpdateSlotUse(worker, queue.leases.size());
  if (worker.may_work() && HasRoom(worker, queue, kUnitsPerSlotMax)) {
    state_.idle.Add(worker.id);
  } else {
    state_.idle.Remove(worker.id);
  }
}

// The lease ends without a result: what its holder has probably done on it was in vain.
double LeaseControl::CountGivenUp(const LeaseRecord& record, double seconds_max) {
  const double seconds =
      std::min(seconds_max, Seconds(state_.workers.occupancy().at() - record.expected_start));
  if (seconds <= 0) return 0;
  state_.counters.waste_s += seconds;
  state_.given_up.push_back({record.lease.unit.job, seconds});
  return seconds;
}

}  // namespace tessera
