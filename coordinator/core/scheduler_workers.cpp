// What workers say they have, and what becomes of it.
#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/policy.h"
#include "coordinator/core/scheduler.h"
#include "renderer/util/check.h"

namespace tessera {
namespace {

constexpr Instant kExpiryInterval = milliseconds(250);  // far below any expiry
constexpr Instant kIdleInterval = seconds(1);

}  // namespace

WorkerRecord& Scheduler::Admit(Instant now, const WorkerState& state) {
  WorkerRecord& worker = workers_[state.worker];
  if (!worker.live) {
    Log(fmt::format("worker_joined worker={:016x} name=\"{}\" slots={}", Number(state.worker), state.name,
                    state.slots));
    worker.live = true;
    worker.notice_told = !worker.is_barred();
    if (worker.is_barred()) news_.insert(state.worker);
  }
  worker.id = state.worker;
  worker.name = state.name;
  worker.software_version = state.software_version;
  worker.tags = state.tags;
  worker.slots = state.slots;
  worker.draining = state.draining;
  worker.last_contact = now;
  return worker;
}

void Scheduler::Synchronize(Instant now, const WorkerState& state) {
  WorkerRecord* const known = FindWorker(state.worker);
  if (known != nullptr && state.sequence < known->sequence) return;  // overtaken on the way
  WorkerRecord& worker = Admit(now, state);
  worker.sequence = state.sequence;
  for (const HeldScene& scene : state.scenes) {
    if (!scene.ready || worker.HasReady(scene.key)) continue;
    ForgetHunger(worker);
    MeasureLoading(now, worker, scene.key);
    preempt_.insert(worker.id);
  }
  worker.scenes.clear();
  worker.fetching = false;
  for (const HeldScene& scene : state.scenes) {
    worker.scenes[scene.key] = scene.ready;
    worker.fetching |= scene.fetching;
  }
  worker.pace.Hear(now, state.activity);
  for (const LeaseId lease : state.returned_leases) {
    const auto held = leases_.find(lease);
    if (held != leases_.end() && held->second.worker == worker.id) Return(lease);
  }
  ReconcileLeases(now, worker, state);
  if (state.leaving) Disconnect(now, state.worker);
  CountSpeed(worker);
  UpdateHunger(worker);
}

void Scheduler::ReconcileLeases(Instant now, WorkerRecord& worker, const WorkerState& state) {
  for (const LeaseId lease : worker.leases) leases_.at(lease).listed = false;
  for (const HeldLease& held : state.leases) {
    const auto known = leases_.find(held.id);
    if (known != leases_.end() && known->second.worker == worker.id &&
        known->second.lease.unit == held.unit) {
      Renew(now, known->second, held);
    } else if (held.stage != LeaseStage::kReturning && !TakeOver(now, worker, held)) {
      Drop(worker, held.id);
    }
  }
  for (const LeaseId lease : std::vector<LeaseId>(worker.leases.begin(), worker.leases.end())) {
    LeaseRecord& record = leases_.at(lease);
    if (record.listed || !record.announced || now - record.announced_at < kAnnounceAgain) continue;
    if (jobs_.at(record.lease.unit.job).paused) {  // it was lost on the way: it shall not begin now
      TakeBack(lease);
      continue;
    }
    record.announced = false;
    worker.unannounced.push_back(lease);
    news_.insert(worker.id);
  }
}

void Scheduler::Renew(Instant now, LeaseRecord& record, const HeldLease& held) {
  record.listed = true;
  record.deadline = now + kLeaseDuration;
  if (held.stage == LeaseStage::kWaiting) return;
  const Instant duration = record.expected_end - record.expected_start;
  record.started = true;
  record.expected_start = now - held.stage_duration;
  record.expected_end = held.stage == LeaseStage::kRunning ? record.expected_start + duration : now;
}

// A lease that a former process gave, or that had expired: if its unit is open, it is valid again.
bool Scheduler::TakeOver(Instant now, WorkerRecord& worker, const HeldLease& held) {
  const bool is_ours = Number(held.id) >> 32 == options_.epoch;
  const bool may_be = !is_ours || (Number(held.id) & 0xffffffff) < lease_next_;
  if (!worker.MayWork() || !may_be || leases_.contains(held.id) || !IsKnown(held.unit)) return false;
  if (worker.revoked.contains(held.id)) return false;
  const JobRecord& job = *FindJob(held.unit.job);
  if (job.paused && held.stage == LeaseStage::kWaiting) return false;
  if (!worker.HasTags(job.spec->required_tags)) return false;
  FrameRecord& frame = *FindFrame(held.unit);
  if (!frame.failures.May(worker.id, held.unit.tile)) return false;
  const TileSamples samples{held.unit.tile, held.unit.range};
  const bool is_free = frame.verification.IsOnTrial(samples)  ? frame.verification.Wants(samples, worker.id)
                       : frame.verification.IsChosen(samples) ? JoinTrial(frame, samples)
                                                              : frame.work.TakeExactly(samples);
  if (!is_free) return false;
  LeaseRecord& record = Grant(now, worker, *FindJob(held.unit.job), frame, held.unit, held.id);
  record.announced = true;
  record.announced_at = now;
  worker.unannounced.pop_back();
  Renew(now, record, held);
  return true;
}

void Scheduler::Disconnect(Instant now, WorkerId worker_id) {
  WorkerRecord* const worker = FindWorker(worker_id);
  if (worker == nullptr || !worker->live) return;
  worker->live = false;
  worker->last_contact = now;
  worker->scenes.clear();
  worker->wanted.clear();
  worker->loading_since.clear();
  worker->prefetch.clear();
  worker->prefetch_told = true;
  ++counters_.workers_lost;
  Log(fmt::format("worker_lost worker={:016x} name=\"{}\" leases={}", Number(worker_id), worker->name,
                  worker->leases.size()));
  for (const LeaseId lease : std::vector<LeaseId>(worker->leases.begin(), worker->leases.end()))
    Return(lease);
  worker->drops.clear();
  news_.erase(worker_id);
  CountSpeed(*worker);
  UpdateHunger(*worker);
}

void Scheduler::Expire(Instant now) {
  if (now < expiry_due_) return;
  expiry_due_ = now + kExpiryInterval;
  std::vector<WorkerId> silent;
  for (const auto& [id, worker] : workers_) {
    if (worker.live && now - worker.last_contact > kWorkerSilenceMax) silent.push_back(id);
  }
  for (const WorkerId id : silent) Disconnect(now, id);
  std::vector<LeaseId> expired;
  for (const auto& [id, record] : leases_) {
    if (now > record.deadline) expired.push_back(id);
  }
  for (const LeaseId id : expired) {
    LeaseRecord& record = leases_.at(id);
    ++counters_.leases_expired;
    Log(fmt::format("lease_expired lease={} worker={:016x} unit=\"{}\"", Number(id), Number(record.worker),
                    record.lease.unit.Text()));
    Drop(workers_.at(record.worker), id);
    Return(id);
  }
  ForgetWorkers(now);
  CondemnWhatAllFailed(now);
}

void Scheduler::ForgetWorkers(Instant now) {
  std::erase_if(workers_, [&](const auto& entry) {
    const auto& [id, worker] = entry;
    const bool forgotten =
        !worker.live && now - worker.last_contact > (worker.is_barred() ? kBarForgotten : kWorkerForgotten);
    if (forgotten) news_.erase(id);
    return forgotten;
  });
}

void Scheduler::Drop(WorkerRecord& worker, LeaseId lease) {
  worker.drops.push_back(lease);
  news_.insert(worker.id);
}

// A drop of what was taken away on purpose, even if a state on its way still lists it.
void Scheduler::Revoke(WorkerRecord& worker, LeaseId lease) {
  Drop(worker, lease);
  worker.revoked.insert(lease);
  if (worker.revoked.size() > kRevokedKeptMax) worker.revoked.erase(worker.revoked.begin());
}

// Keeps the sums of all workers in step with this one.
void Scheduler::CountSpeed(WorkerRecord& worker) {
  const int slots = worker.MayWork() ? worker.slots : 0;
  const double speed = slots * worker.speed;
  total_slots_ += slots - worker.slots_counted;
  total_speed_ = total_slots_ == 0 ? 0 : total_speed_ + speed - worker.speed_counted;
  worker.slots_counted = slots;
  worker.speed_counted = speed;
}

Instant Scheduler::TickInterval() const {
  if (!starved_.empty() && !leases_.empty()) return kTailInterval;
  return workers_.empty() && jobs_.empty() ? kIdleInterval : kExpiryInterval;
}

bool Scheduler::HasNews(WorkerId id) const {
  const auto found = workers_.find(id);
  if (found == workers_.end()) return false;
  const WorkerRecord& worker = found->second;
  return !worker.unannounced.empty() || !worker.drops.empty() || !worker.notice_told || !worker.wanted_told ||
         !worker.prefetch_told;
}

Scheduler::Grants Scheduler::TakeGrants(Instant now, WorkerId id) {
  WorkerRecord* const worker = FindWorker(id);
  if (worker == nullptr) return {};
  Grants grants;
  for (const LeaseId lease : std::exchange(worker->unannounced, {})) {
    LeaseRecord& record = leases_.at(lease);
    const WorkUnit& unit = record.lease.unit;
    if (FindFrame(unit)->work.HasDone(
            {unit.tile, unit.range})) {  // others were quicker: what is left is cut anew
      Return(lease);
      continue;
    }
    record.announced = true;
    record.announced_at = now;
    grants.leases.push_back(record.lease);
  }
  grants.drop = std::exchange(worker->drops, {});
  if (worker->wanted_told && worker->notice_told && worker->prefetch_told) news_.erase(id);
  return grants;
}

WorkerDirective Scheduler::TakeDirective(Instant now, WorkerId id) {
  WorkerRecord* const worker = FindWorker(id);
  WorkerDirective directive;
  if (worker == nullptr) return directive;
  Grants grants = TakeGrants(now, id);
  directive.leases = std::move(grants.leases);
  directive.drop = std::move(grants.drop);
  for (const SceneOrder& scene : worker->wanted) {
    if (worker->scenes.contains(scene.key)) continue;
    directive.scenes.push_back(scene);
    worker->loading_since.try_emplace(scene.key, now);
  }
  worker->wanted_told = true;
  if (!worker->prefetch_told) directive.prefetch = worker->prefetch;
  worker->prefetch_told = true;
  directive.notice = worker->quarantined() ? worker->quarantine
                     : worker->drained     ? "drained by the operator"
                                           : "";
  worker->notice_told = true;
  news_.erase(id);
  return directive;
}

std::vector<WorkerStatus> Scheduler::Workers(Instant now) const {
  std::vector<WorkerStatus> all;
  const double average = total_slots_ > 0 ? total_speed_ / total_slots_ : 1;
  for (const auto& [id, worker] : workers_) {
    if (!worker.live) continue;
    WorkerStatus status;
    status.worker = id;
    status.name = worker.name;
    status.slots = worker.slots;
    status.software_version = worker.software_version;
    status.leases = static_cast<uint32_t>(worker.leases.size());
    status.units_finished = worker.units_finished;
    status.units_failed = worker.units_failed;
    status.speed = worker.speed / average;
    status.silent = std::chrono::duration_cast<std::chrono::milliseconds>(now - worker.last_contact);
    status.draining = worker.draining || worker.drained;
    status.quarantined = worker.quarantined();
    status.reason = worker.quarantine;
    status.utilisation = worker.pace.Utilisation(worker.slots);
    status.samples_per_second = worker.pace.SamplesPerSecond(now);
    status.fetching = worker.fetching;
    status.loading = worker.IsLoading();
    status.tags = worker.tags;
    all.push_back(std::move(status));
  }
  return all;
}

}  // namespace tessera
