#include "coordinator/core/schedule/failure_handling.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/schedule/policy.h"
#include "renderer/text/unicode.h"

namespace tessera {

bool FailureHandling::Hold(WorkerId worker, LeaseId lease, const WorkUnit& unit) const {
  return state_.leases.IsHeldBy(lease, worker) && state_.leases.At(lease).lease.unit == unit;
}

void FailureHandling::FailUnit(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit,
                               const std::string& reason) {
  if (!Hold(worker, lease, unit)) return;
  leases_.Return(lease);
  RecordFailure(now, worker, unit, reason);
}

void FailureHandling::RecordFailure(Instant now, WorkerId worker_id, const WorkUnit& unit,
                                    const std::string& reason) {
  WorkerRecord& worker = state_.workers.At(worker_id);
  ActiveFrame& frame = *state_.jobs.FindFrame(unit);
  const TileSamples samples{unit.tile, unit.range};
  if (frame.work.IsDone(samples)) return;
  ++worker.units_failed;
  worker.last_failure = reason;
  ++state_.counters.units_failed;
  state_.log.push_back(fmt::format("unit_failed worker={:016x} name={} unit={} reason={}", Number(worker_id),
                                   LogText(worker.name), LogText(unit.Text()), LogText(reason)));
  state_.Warn(unit.job, fmt::format("worker {} did not render {}: {}", worker.name,
                                    UnitText(*state_.jobs.At(unit.job).spec, unit), reason));
  frame.failures.Record({samples, worker_id, worker.name + ": " + reason, now});
  if (const auto fatal = frame.failures.FatalReason(attempts_max_))
    FailJob(unit.job, "a unit cannot be rendered: " + *fatal);
}

void FailureHandling::FailScene(Instant now, WorkerId worker_id, const Digest& scene,
                                const std::string& reason) {
  WorkerRecord* const worker = state_.workers.Find(worker_id);
  if (worker == nullptr || !worker->Expects(scene)) return;
  worker->scenes.erase(scene);
  std::erase_if(worker->wanted, [&](const SceneRequest& order) { return order.key == scene; });
  worker->loading_since.erase(scene);
  state_.idle.Remove(worker_id);
  state_.log.push_back(fmt::format("scene_failed worker={:016x} name={} scene={} reason={}",
                                   Number(worker_id), LogText(worker->name), scene.Hex(), LogText(reason)));
  const std::vector<LeaseId> leases = state_.leases.OfWorker(worker_id);
  for (const LeaseId lease : leases) {
    if (state_.leases.At(lease).lease.unit.scene == scene) leases_.Return(lease);
  }
  ++worker->units_failed;
  worker->last_failure = reason;
  for (const auto& [id, job] : state_.jobs.open()) {
    bool is_told = false;
    for (auto& [index, frame] : job->schedule.active) {
      if (frame.scene.key != scene) continue;
      if (!std::exchange(is_told, true))
        state_.Warn(id, fmt::format("worker {} did not load the scene: {}", worker->name, reason));
      frame.failures.Record({std::nullopt, worker_id, worker->name + ": " + reason, now});
      if (const auto fatal = frame.failures.FatalReason(attempts_max_))
        FailJob(id, "the scene cannot be loaded: " + *fatal);
    }
  }
  leases_.UpdateRoom(*worker);
}

// Without the lease anybody may have sent the result in the worker's name, so it does not count against it.
void FailureHandling::RefuseResult(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit,
                                   const std::string& reason) {
  if (!Hold(worker, lease, unit)) return;
  FailUnit(now, worker, lease, unit, reason);
  Strike(worker, "returned wrong results: " + reason);
}

void FailureHandling::Disprove(WorkerId by, const WorkUnit& unit, ActiveFrame& frame) {
  if (frame.failures.empty()) return;
  const auto is_done = [&](TileSamples samples) { return frame.work.IsDone(samples); };
  for (const WorkerId at_fault : frame.failures.Disprove(unit.tile, by, is_done))
    Strike(at_fault, "failed units that others finished");
  state_.idle.UnblockAll();  // those at fault may try again
}

void FailureHandling::Strike(WorkerId id, const std::string& reason) {
  WorkerRecord* const worker = state_.workers.Find(id);
  if (worker != nullptr && WorkerRoster::AddStrike(*worker)) Quarantine(*worker, reason);
}

void FailureHandling::Quarantine(WorkerRecord& worker, const std::string& reason) {
  if (!state_.workers.Quarantine(worker, reason)) return;
  state_.idle.Remove(worker.id);
  leases_.UpdateRoom(worker);
  state_.log.push_back(fmt::format("worker_quarantined worker={:016x} name={} reason={}", Number(worker.id),
                                   LogText(worker.name), LogText(reason)));
  const std::vector<LeaseId> leases = state_.leases.OfWorker(worker.id);
  for (const auto& [job, units] : state_.leases.UnitsOf(worker.id))
    state_.Warn(job, fmt::format("worker {} is quarantined: {}", worker.name, reason));
  for (const LeaseId lease : leases) {
    state_.workers.Drop(worker, lease);
    leases_.Return(lease);
  }
}

void FailureHandling::FailJob(JobId job, const std::string& reason) {
  const bool is_known =
      std::any_of(failed_.begin(), failed_.end(), [&](const FailedJob& each) { return each.job == job; });
  if (!is_known) failed_.push_back({job, reason});
}

void FailureHandling::FailWhatAllFailed(Instant now) {
  if (now < kPoisonGrace) return;
  for (const auto& [id, job] : state_.jobs.open()) {
    std::set<WorkerId> able;  // filled for the few jobs that have failures
    for (const auto& [index, frame] : job->schedule.active) {
      if (frame.failures.empty()) continue;
      if (able.empty()) able = state_.workers.AbleFor(job->spec->required_tags);
      if (able.empty()) break;  // a worker that joins may be able to render it
      if (const auto fatal = frame.failures.FatalReasonOfAll(able, now - kPoisonGrace))
        FailJob(id, "a unit cannot be rendered: " + *fatal);
    }
  }
}

std::string FailureHandling::WhyNoneMay(const Job& job, const std::set<WorkerId>& able) {
  for (const auto& [index, frame] : job.schedule.active) {
    if (frame.failures.empty()) continue;
    if (const auto why = frame.failures.FatalReasonOfAll(able, Instant::max()))
      return "every worker that is connected failed a unit of it, so another one is needed: " + *why;
  }
  return {};
}

}  // namespace tessera
