#include "coordinator/core/schedule/failure_handling.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/schedule/policy.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

std::string TextOf(const FailureBook::Reason& fatal) {
  return (fatal.is_scene ? "the scene cannot be loaded: " : "a unit cannot be rendered: ") + fatal.text;
}

}  // namespace

bool FailureHandling::Hold(WorkerId worker, LeaseId lease, const WorkUnit& unit) const {
  return state_.leases.IsHeldBy(lease, worker) && state_.leases.At(lease).lease.unit == unit;
}

void FailureHandling::FailUnit(WorkerId worker, LeaseId lease, const WorkUnit& unit,
                               const std::string& reason) {
  if (!Hold(worker, lease, unit)) return;
  leases_.Return(lease);
  RecordFailure(worker, unit, reason);
}

void FailureHandling::RecordFailure(WorkerId worker_id, const WorkUnit& unit, const std::string& reason) {
  WorkerRecord& worker = state_.workers.At(worker_id);
  ActiveFrame& frame = *state_.jobs.FindFrame(unit);
  const TileSamples samples{unit.tile, unit.range};
  if (frame.work.IsDone(samples)) return;
  ++worker.units_failed;
  worker.last_failure = reason;
  ++state_.counters.units_failed;
  state_.log.push_back(fmt::format("unit_failed worker={:016x} name={} unit={} reason={}", Number(worker_id),
                                   LogText(worker.name), LogText(unit.Text()), LogText(reason)));
  const Job& job = state_.jobs.At(unit.job);
  state_.Warn(unit.job,
              fmt::format("worker {} did not render {}: {}", worker.name, UnitText(*job.spec, unit), reason));
  frame.failures.Record({samples, worker_id, worker.member, worker.name + ": " + reason});
  Judge(job, unit.frame, frame);
}

void FailureHandling::Judge(const Job& job, uint32_t index, const ActiveFrame& frame) {
  const auto fatal = frame.failures.FatalReason(
      attempts_max_, [&] { return state_.workers.PartiesFor(job.spec->required_tags); });
  if (fatal) FailFrame(job, index, TextOf(*fatal));
}

void FailureHandling::Withdraw(WorkerRecord& worker, const Digest& scene) {
  worker.scenes.erase(scene);
  std::erase_if(worker.wanted, [&](const SceneRequest& order) { return order.key == scene; });
  worker.loading_since.erase(scene);
  state_.idle.Remove(worker.id);
  const std::vector<LeaseId> leases = state_.leases.OfWorker(worker.id);
  for (const LeaseId lease : leases) {
    if (state_.leases.At(lease).lease.unit.scene == scene) leases_.Return(lease);
  }
}

void FailureHandling::FailScene(WorkerId worker_id, const Digest& scene, const std::string& reason,
                                FailureCause cause) {
  WorkerRecord* const worker = state_.workers.Find(worker_id);
  if (worker == nullptr || !worker->Expects(scene)) return;
  state_.log.push_back(fmt::format("scene_failed worker={:016x} name={} scene={} reason={}",
                                   Number(worker_id), LogText(worker->name), scene.Hex(), LogText(reason)));
  Withdraw(*worker, scene);
  ++worker->units_failed;
  worker->last_failure = reason;
  bool is_at_fault = false;
  for (const auto& [id, job] : state_.jobs.open()) {
    bool is_told = false;
    for (auto& [index, frame] : job->schedule.active) {
      if (frame.scene.key != scene) continue;
      if (!std::exchange(is_told, true))
        state_.Warn(id, fmt::format("worker {} did not load the scene: {}", worker->name, reason));
      if (cause == FailureCause::kScene && frame.failures.IsSceneRendered()) {
        is_at_fault = true;
        continue;
      }
      frame.failures.Record({std::nullopt, worker_id, worker->member, worker->name + ": " + reason}, cause);
      Judge(*job, index, frame);
    }
  }
  leases_.UpdateRoom(*worker);
  if (is_at_fault) Strike(worker_id, "could not load a scene that was rendered: " + reason);
}

// Without the lease anybody may have sent the result in the worker's name, so it does not count against it.
void FailureHandling::RefuseResult(WorkerId worker, LeaseId lease, const WorkUnit& unit,
                                   const std::string& reason) {
  if (!Hold(worker, lease, unit)) return;
  FailUnit(worker, lease, unit, reason);
  Strike(worker, "returned wrong results: " + reason);
}

void FailureHandling::Disprove(WorkerId by, const WorkUnit& unit, ActiveFrame& frame) {
  frame.failures.NoteRendered();
  if (!frame.failures.CanDisprove()) return;
  const auto is_done = [&](TileSamples samples) { return frame.work.IsDone(samples); };
  for (const WorkerId at_fault : frame.failures.Disprove(unit.tile, by, is_done))
    Strike(at_fault, "failed units that others finished");
  state_.idle.UnblockAll();  // those at fault may try again
}

void FailureHandling::Strike(WorkerId id, const std::string& reason) {
  WorkerRecord* const worker = state_.workers.Find(id);
  if (worker != nullptr && state_.workers.AddStrike(*worker)) Quarantine(*worker, reason);
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

// What one frame needs says nothing about the others.
void FailureHandling::FailFrame(const Job& job, uint32_t index, const std::string& reason) {
  if (job.spec->frames.size() == 1) return FailJob(job.id, reason);
  const bool is_known = std::ranges::any_of(
      failed_frames_, [&](const FailedFrame& each) { return each.job == job.id && each.frame == index; });
  if (!is_known) failed_frames_.push_back({job.id, index, reason});
}

void FailureHandling::FailWhatAllFailed(Instant now) {
  for (const auto& [id, job] : state_.jobs.open()) {
    std::optional<std::set<WorkerId>> able;  // for the few jobs that have failures
    for (auto& [index, frame] : job->schedule.active) {
      if (frame.failures.empty()) continue;
      if (!able) able = state_.workers.AbleFor(job->spec->required_tags);
      const bool are_all_here =
          attempts_max_ < kAttemptsMaxDefault && able->size() >= static_cast<size_t>(attempts_max_);
      // If none is able, a worker that joins may be able to render it.
      const Instant grace = are_all_here ? Instant{} : kPoisonGrace;
      if (const auto fatal = frame.failures.FatalReasonOfAll(now, *able, grace))
        FailFrame(*job, index, TextOf(*fatal));
    }
  }
}

std::string FailureHandling::WhyNoneMay(const Job& job, const std::set<WorkerId>& able) {
  for (const auto& [index, frame] : job.schedule.active) {
    if (frame.failures.empty()) continue;
    if (const auto why = frame.failures.ReasonOfAll(able)) {
      return fmt::format("every worker that is connected failed {}, so another one is needed: {}",
                         why->is_scene ? "to load the scene" : "a unit of it", why->text);
    }
  }
  return {};
}

}  // namespace tessera
