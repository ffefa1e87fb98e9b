#include "coordinator/core/schedule/worker_sync.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/schedule/policy.h"
#include "renderer/text/unicode.h"

namespace tessera {

void WorkerSync::Synchronize(Instant now, const WorkerState& state) {
  const WorkerRecord* const known = state_.workers.Find(state.worker);
  const bool is_late = known != nullptr && state.sequence < known->sequence;
  if (is_late && now - known->sequence_at < kStateReorderMax) return;
  if (known == nullptr) {
    if (const auto forgotten = state_.workers.MakePlace()) state_.leases.ForgetWorker(*forgotten);
  }
  const auto [record, is_new] = state_.workers.Admit(now, state);
  WorkerRecord& worker = *record;
  // A process that belongs to a farm has had its own blocks before.
  if (known == nullptr && state.farm == FarmId{}) {
    if (const auto former = state_.workers.TakeOverBlock(worker))
      state_.log.push_back(fmt::format("worker_block_taken_over worker={:016x} name={} former={:016x}",
                                       Number(worker.id), LogText(worker.name), Number(*former)));
  }
  if (known == nullptr && !worker.is_quarantined()) state_.workers.TakeOverStrikes(worker);
  if (is_new) {
    state_.losses.Return(worker.id);
    state_.log.push_back(fmt::format("worker_joined worker={:016x} name={} slots={}", Number(worker.id),
                                     LogText(worker.name), worker.slots));
  }
  worker.sequence = state.sequence;
  worker.sequence_at = now;
  UpdateScenes(now, worker, state);
  worker.pace.Record(now, state.activity);
  for (const LeaseId lease : state.returned_leases) {
    if (state_.leases.IsHeldBy(lease, worker.id)) leases_.Return(lease);
  }
  ReconcileLeases(now, worker, state);
  if (state.leaving) Disconnect(now, worker.id, Departure::kGoodbye);
  state_.workers.UpdateTotals(worker);
  leases_.UpdateRoom(worker);
}

void WorkerSync::UpdateScenes(Instant now, WorkerRecord& worker, const WorkerState& state) {
  for (const HeldScene& scene : state.scenes) {
    if (!scene.ready || worker.has_ready(scene.key)) continue;
    state_.idle.Remove(worker.id);  // there may be work for it with this scene
    scenes_.MeasureLoading(now, worker, scene.key);
    dispatcher_.MarkForPreemption(worker.id);
  }
  worker.scenes.clear();
  worker.is_fetching = false;
  for (const HeldScene& scene : state.scenes) {
    worker.scenes[scene.key] = scene.ready;
    worker.is_fetching |= scene.fetching;
  }
}

void WorkerSync::ReconcileLeases(Instant now, WorkerRecord& worker, const WorkerState& state) {
  for (const LeaseId lease : state_.leases.OfWorker(worker.id)) state_.leases.At(lease).is_listed = false;
  for (const HeldLease& held : state.leases) {
    LeaseRecord* const known = state_.leases.Find(held.id);
    if (known != nullptr && known->worker == worker.id && known->lease.unit == held.unit) {
      LeaseTable::Renew(now, *known, held);
    } else if (!TakeOver(now, worker, held) && held.stage != LeaseStage::kReturning) {
      // A result that is on its way is let come: it may be accepted yet.
      state_.workers.Drop(worker, held.id);
    }
  }
  AnnounceAgain(now, worker);
}

// Leases that were announced and that the state does not list were lost on the way.
void WorkerSync::AnnounceAgain(Instant now, WorkerRecord& worker) {
  const std::vector<LeaseId> leases = state_.leases.OfWorker(worker.id);
  for (const LeaseId lease : leases) {
    LeaseRecord& record = state_.leases.At(lease);
    if (record.is_listed || !record.is_announced || now - record.announced_at < kAnnounceAgain) continue;
    if (state_.jobs.At(record.lease.unit.job).is_paused) {
      leases_.Revoke(lease);
      continue;
    }
    record.is_announced = false;
    state_.workers.Announce(worker, lease);
  }
}

// A lease that a former process gave or that has expired is valid again if its unit is open.
bool WorkerSync::TakeOver(Instant now, WorkerRecord& worker, const HeldLease& held) {
  const bool may_be = state_.leases.MayHaveGiven(held.id) && !state_.leases.Has(held.id);
  if (!worker.may_work() || !may_be || !state_.jobs.IsKnown(held.unit)) return false;
  if (worker.revoked.contains(held.id)) return false;
  Job& job = state_.jobs.At(held.unit.job);
  if (job.is_paused && held.stage == LeaseStage::kWaiting) return false;
  if (!worker.has_tags(job.spec->required_tags)) return false;
  if (state_.jobs.FindFrame(held.unit) == nullptr && !state_.jobs.MayStretch(job, held.unit.frame))
    return false;
  ActiveFrame& frame = *state_.jobs.FindOrBegin(held.unit);
  if (!frame.failures.May(worker.id, held.unit.tile)) return false;
  const TileSamples samples{held.unit.tile, held.unit.range};
  const bool is_free = frame.verification.IsVerifying(samples)
                           ? frame.verification.NeedsVoteOf(samples, state_.VoterOf(worker))
                       : frame.verification.IsChosen(samples) ? votes_.JoinVerification(frame, samples)
                                                              : frame.work.TakeExactly(samples);
  if (!is_free) return false;
  LeaseRecord& record = leases_.Grant(now, worker, job, frame, held.unit, held.id);
  record.is_announced = true;
  record.announced_at = now;
  worker.pending.leases.pop_back();
  LeaseTable::Renew(now, record, held);
  return true;
}

void WorkerSync::Disconnect(Instant now, WorkerId id, Departure how) {
  WorkerRecord* const worker = state_.workers.Find(id);
  if (worker == nullptr || !worker->is_live) return;
  if (how != Departure::kGoodbye) trials_.Lose(now, *worker, how == Departure::kSilent);
  state_.workers.Disconnect(now, *worker);
  ++state_.counters.workers_lost;
  state_.log.push_back(fmt::format("worker_lost worker={:016x} name={} leases={}", Number(id),
                                   LogText(worker->name), state_.leases.OfWorker(id).size()));
  if (how != Departure::kGoodbye) {
    for (const auto& [job, units] : state_.leases.UnitsOf(id))
      state_.Warn(job, fmt::format("worker {} is gone; its {} unit{} go back to the others", worker->name,
                                   units, units == 1 ? "" : "s"));
  }
  leases_.ReturnAllOf(id);
  worker->pending.drops.clear();
  state_.workers.UpdateNews(*worker);
  state_.workers.UpdateTotals(*worker);
  leases_.UpdateRoom(*worker);
}

void WorkerSync::Expire(Instant now) {
  for (const WorkerId id : state_.workers.Silent(now)) Disconnect(now, id, Departure::kSilent);
  for (const LeaseId id : state_.leases.Expired(now)) {
    const LeaseRecord& record = state_.leases.At(id);
    ++state_.counters.leases_expired;
    state_.log.push_back(fmt::format("lease_expired lease={} worker={:016x} unit={}", id.number,
                                     Number(record.worker), LogText(record.lease.unit.Text())));
    const WorkUnit& unit = record.lease.unit;
    state_.Warn(unit.job,
                fmt::format("worker {} did not return {} in time", state_.workers.At(record.worker).name,
                            UnitText(*state_.jobs.At(unit.job).spec, unit)));
    state_.workers.Drop(state_.workers.At(record.worker), id);
    leases_.Return(id);
  }
  for (const WorkerId id : state_.workers.ForgetGone(now)) state_.leases.ForgetWorker(id);
}

LeaseGrants WorkerSync::TakeGrants(Instant now, WorkerId id) {
  WorkerRecord* const worker = state_.workers.Find(id);
  if (worker == nullptr) return {};
  LeaseGrants grants;
  size_t bytes = 0;
  const std::vector<LeaseId> pending = std::exchange(worker->pending.leases, {});
  for (auto next = pending.begin(); next != pending.end(); ++next) {
    const LeaseId lease = *next;
    LeaseRecord& record = state_.leases.At(lease);
    bytes += kLeaseBytes + record.lease.pixels.Bytes().size();
    if (bytes > kGrantBytesMax && !grants.leases.empty()) {
      worker->pending.leases.assign(next, pending.end());
      break;
    }
    const WorkUnit& unit = record.lease.unit;
    if (state_.jobs.FindFrame(unit)->work.HasDone({unit.tile, unit.range})) {
      leases_.Return(lease);  // others were faster: what is left of it is cut anew
      continue;
    }
    record.is_announced = true;
    record.announced_at = now;
    grants.leases.push_back(record.lease);
  }
  std::vector<LeaseId>& drops = worker->pending.drops;
  const auto end = drops.begin() + static_cast<std::ptrdiff_t>(std::min(drops.size(), kDropsPerAnswerMax));
  grants.drop.assign(drops.begin(), end);
  drops.erase(drops.begin(), end);
  state_.workers.UpdateNews(*worker);
  return grants;
}

WorkerDirective WorkerSync::TakeDirective(Instant now, WorkerId id) {
  WorkerRecord* const worker = state_.workers.Find(id);
  if (worker == nullptr) return {};
  LeaseGrants grants = TakeGrants(now, id);
  WorkerDirective directive = state_.workers.TakeRequests(now, *worker);
  directive.leases = std::move(grants.leases);
  directive.drop = std::move(grants.drop);
  return directive;
}

}  // namespace tessera
