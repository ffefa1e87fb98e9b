// Units that two workers render: their results count when they agree.
#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/policy.h"
#include "coordinator/core/scheduler.h"

namespace tessera {
namespace {

std::string Names(const std::vector<Opinion>& opinions) {
  std::string names;
  for (const Opinion& each : opinions) names += (names.empty() ? "" : ", ") + each.name;
  return names;
}

}  // namespace

bool Scheduler::IsTrusted(WorkerId id) const {
  const auto worker = workers_.find(id);
  return worker == workers_.end() || !worker->second.quarantined();
}

bool Scheduler::NeedsVerification(const WorkUnit& unit) {
  const TileSamples samples{unit.tile, unit.range};
  const FrameRecord& frame = *FindFrame(unit);
  return frame.verification.IsChosen(samples) || frame.verification.Touches(samples);
}

// The samples have been taken out of the open ones.
void Scheduler::BeginTrial(FrameRecord& frame, TileSamples samples) {
  frame.verification.Begin(samples);
  AnnounceWork();  // others may render it, too
}

// Whether the unit is on trial by now: it may be put on trial if it is chosen and still open as a whole.
bool Scheduler::JoinTrial(FrameRecord& frame, TileSamples samples) {
  if (frame.verification.IsOnTrial(samples)) return true;
  if (!frame.verification.IsChosen(samples) || !frame.work.TakeExactly(samples)) return false;
  BeginTrial(frame, samples);
  return true;
}

Scheduler::Hearing Scheduler::Hear(Instant now, WorkerId worker_id, LeaseId lease, const WorkUnit& unit,
                                   double render_seconds, const Digest& result) {
  FrameRecord& frame = *FindFrame(unit);
  const TileSamples samples{unit.tile, unit.range};
  if (frame.work.IsDone(samples))
    return {Hearing::Outcome::kBelieved, false, {}};  // which Finish knows as a copy
  if (!JoinTrial(frame, samples)) {
    const auto held = leases_.find(lease);
    if (held != leases_.end() && held->second.worker == worker_id) Return(lease);
    return {};
  }
  EndLease(now, worker_id, lease, unit);
  WorkerRecord* const worker = FindWorker(worker_id);
  const std::string name = worker != nullptr ? worker->name : fmt::format("{:016x}", Number(worker_id));
  const auto judgement = frame.verification.Hear(samples, {worker_id, name, result});
  AnnounceWork();  // the unit may want somebody else by now
  if (!judgement.is_new) return {};
  const size_t different = judgement.opinions.size() - (judgement.decided ? 1 : 0);
  const Hearing hearing{judgement.decided ? Hearing::Outcome::kBelieved : Hearing::Outcome::kHeld, true,
                        name};
  if (different > 1) {
    Log(fmt::format("result_disputed unit=\"{}\" workers=\"{}\"", unit.Text(), Names(judgement.opinions)));
  }
  for (const Opinion& dissenter : judgement.dissenters) {
    Disbelieve(dissenter.worker, fmt::format("its result of {} is not what two others found", unit.Text()));
  }
  if (judgement.decided) return hearing;
  if (worker != nullptr) Credit(*worker, frame, unit, render_seconds);
  if (different >= static_cast<size_t>(std::max(2, options_.attempts_max))) {
    Condemn(*FindJob(unit.job),
            fmt::format("{} differs on every worker that rendered it ({}), so none can be believed",
                        unit.Text(), Names(judgement.opinions)));
  }
  return hearing;
}

void Scheduler::RestoreOpinion(const WorkUnit& unit, const Opinion& opinion) {
  if (!IsKnown(unit) || !IsTrusted(opinion.worker)) return;
  FrameRecord& frame = *FindFrame(unit);
  const TileSamples samples{unit.tile, unit.range};
  if (JoinTrial(frame, samples)) frame.verification.Hear(samples, opinion);
}

// The worker is alone with its result. What else it said is void; what was merged before cannot be told from
// the rest any more.
void Scheduler::Disbelieve(WorkerId id, const std::string& reason) {
  disbelieved_.push_back(id);
  for (auto& [job_id, job] : jobs_) {
    for (auto& [index, frame] : job.frames) {
      for (const TileSamples samples : frame.verification.Disbelieve(id)) GiveBack(frame, samples);
    }
  }
  WorkerRecord* const worker = FindWorker(id);
  if (worker != nullptr && !worker->quarantined()) Quarantine(*worker, reason);
}

}  // namespace tessera
