#include "coordinator/core/schedule/dispatcher.h"

#include <algorithm>

#include "coordinator/core/schedule/policy.h"
#include "renderer/util/check.h"

namespace tessera {

// In rounds, so that no worker has units waiting while another has a slot without one.
void Dispatcher::Dispatch(Instant now) {
  for (const int per_slot : {1, kUnitsPerSlotMin, kUnitsPerSlotMax}) {
    for (const WorkerId id : std::vector<WorkerId>(state_.idle.idle().begin(), state_.idle.idle().end())) {
      WorkerRecord& worker = state_.workers.At(id);
      while (leases_.HasRoom(worker, per_slot)) {
        if (GrantOne(now, worker)) continue;
        state_.idle.Block(id);
        break;
      }
    }
  }
}

bool Dispatcher::GrantOne(Instant now, WorkerRecord& worker) {
  if (const auto trial = trials_.TrialOf(now, worker)) return GrantTrial(now, worker, *trial);
  const FrameChoice choice = Choose(now, worker, std::nullopt);
  if (choice.frame == nullptr) return false;
  GrantFrom(now, worker, choice);
  scenes_.RequestNext(now, worker, choice);
  return true;
}

// The worker finishes what it holds first and gets nothing else, so that there is one cause if it vanishes.
bool Dispatcher::GrantTrial(Instant now, WorkerRecord& worker, const SuspectTrials::Trial& trial) {
  if (!state_.leases.OfWorker(worker.id).empty()) return false;
  if (!worker.has_ready(trial.choice.frame->scene.key)) {
    scenes_.Request(worker, trial.choice);
    return false;
  }
  GrantFrom(now, worker, trial.choice, [&](uint32_t tile) { return trial.Allows(worker.id, tile); });
  return true;
}

void Dispatcher::GrantFrom(Instant now, WorkerRecord& worker, const FrameChoice& choice) {
  const FailureBook& failures = choice.frame->failures;
  GrantFrom(now, worker, choice, [&](uint32_t tile) { return failures.May(worker.id, tile); });
}

void Dispatcher::GrantFrom(Instant now, WorkerRecord& worker, const FrameChoice& choice,
                           const MayRender& may) {
  ActiveFrame& frame = *choice.frame;
  auto samples = frame.verification.Find(state_.VoterOf(worker), may);
  if (!samples) {
    const double seconds =
        JobQueue::UnitSeconds(*choice.job, state_.workers.total_slots(), state_.workers.total_speed());
    samples = frame.work.Take(seconds * worker.speed, may);
    TESSERA_CHECK(samples.has_value());
    if (frame.verification.IsChosen(*samples)) {
      frame.verification.Begin(*samples);
      state_.idle.UnblockAll();  // others may render it as well
    }
  }
  const WorkUnit unit{choice.job->id, choice.index, samples->tile, samples->range, frame.scene.key};
  leases_.Grant(now, worker, *choice.job, frame, unit, state_.leases.NextId());
}

FrameChoice Dispatcher::Choose(Instant now, WorkerRecord& worker, std::optional<int> above_priority) {
  const FrameChoice choice = ChooseByPriority(now, worker, above_priority);
  if (choice.frame != nullptr || above_priority || !state_.jobs.has_refused()) return choice;
  if (worker.waits_for_scene() || !BeginFor(worker)) return choice;
  return ChooseByPriority(now, worker, std::nullopt);
}

bool Dispatcher::MayHelpLater(const WorkerRecord& worker) const {
  for (const auto& [priority, jobs] : state_.jobs.runnable()) {
    for (const JobId id : jobs) {
      const Job& job = state_.jobs.At(id);
      if (state_.leases.ShareOf(id).leases == 0 || !worker.has_tags(job.spec->required_tags)) continue;
      const bool may_load = std::ranges::any_of(job.schedule.active, [&](const auto& frame) {
        return !frame.second.failures.HasFailedScene(worker.id);
      });
      if (may_load) return true;
    }
  }
  return false;
}

// Frames of jobs that are paused, or that the worker cannot load, must not hold it up. The memory of the
// coordinator is limited all the same, so there is one such frame at a time.
bool Dispatcher::MayExceedFor(const WorkerRecord& worker) const {
  return state_.leases.OfWorker(worker.id).empty() && state_.jobs.MayExceed() && !MayHelpLater(worker);
}

// Begins a frame for the worker although the limits are reached, because no active frame has work for it.
bool Dispatcher::BeginFor(const WorkerRecord& worker) {
  for (const auto& [priority, jobs] : state_.jobs.runnable()) {
    for (const JobId id : jobs) {
      Job& job = state_.jobs.At(id);
      const std::set<uint32_t>& ahead = job.schedule.ahead;
      if (ahead.empty() || job.schedule.active.size() >= kFramesActiveMax) continue;
      if (!worker.has_tags(job.spec->required_tags)) continue;
      const uint32_t next = *ahead.begin();
      if (state_.jobs.MayBegin(job, next)) continue;  // it has open frames, but not for this worker
      if (!state_.jobs.MayStretch(job, next) && !MayExceedFor(worker)) return false;
      state_.jobs.Begin(job, next);
      state_.idle.UnblockAll();
      return true;
    }
  }
  return false;
}

FrameChoice Dispatcher::ChooseByPriority(Instant now, WorkerRecord& worker,
                                         std::optional<int> above_priority) {
  for (const auto& [priority, jobs] : state_.jobs.runnable()) {
    if (above_priority && priority <= *above_priority) break;
    if (const FrameChoice choice = ChooseAmong(now, worker, jobs); choice.frame != nullptr) return choice;
  }
  return {};
}

// Of jobs with equal rights, the one that has the least of the farm's time: first among those whose scene the
// worker has in memory. Time, not units: jobs cut their units to different lengths.
FrameChoice Dispatcher::ChooseAmong(Instant now, WorkerRecord& worker, const std::set<JobId>& jobs) {
  const auto share_s = [&](const FrameChoice& choice) {
    return state_.leases.ShareOf(choice.job->id).seconds;
  };
  FrameChoice ready, unready;
  for (const JobId id : jobs) {
    Job& job = state_.jobs.At(id);
    if (!worker.has_tags(job.spec->required_tags)) continue;
    scenes_.Activate(job);
    if (const FrameChoice choice = scenes_.ReadyFrame(job, worker); choice.frame != nullptr) {
      if (ready.job == nullptr || share_s(choice) < share_s(ready)) ready = choice;
    } else if (const FrameChoice other = scenes_.FrameToLoad(now, job, worker); other.frame != nullptr) {
      if (unready.job == nullptr || share_s(other) < share_s(unready)) unready = other;
    }
  }
  // A scene is loaded if there is nothing else to do, or for a job that has much less than its share.
  if (unready.job != nullptr && (ready.job == nullptr || share_s(unready) * 2 < share_s(ready)))
    scenes_.Request(worker, unready);
  return ready;
}

void Dispatcher::AnnounceJob() {
  for (const auto& [id, worker] : state_.workers.all()) {
    if (!state_.leases.OfWorker(id).empty()) preempt_.insert(id);
  }
  state_.idle.UnblockAll();
}

void Dispatcher::Preempt(Instant now) {
  const std::set<WorkerId> marked = std::exchange(preempt_, {});
  if (state_.jobs.runnable().size() < 2) return;
  for (const WorkerId id : marked) {
    WorkerRecord* const worker = state_.workers.Find(id);
    if (worker != nullptr && worker->may_work()) PreemptAt(now, *worker);
  }
}

void Dispatcher::PreemptAt(Instant now, WorkerRecord& worker) {
  while (const auto victim = LeastUrgentWaiting(now, worker.id)) {
    const JobId job = state_.leases.At(*victim).lease.unit.job;
    const FrameChoice choice = Choose(now, worker, state_.jobs.At(job).priority);
    if (choice.frame == nullptr) return;
    leases_.Revoke(*victim);
    GrantFrom(now, worker, choice);
  }
}

// The youngest lease of the lowest priority.
std::optional<LeaseId> Dispatcher::LeastUrgentWaiting(Instant now, WorkerId worker) const {
  std::optional<LeaseId> least;
  int lowest = 0;
  for (const LeaseId id : state_.leases.OfWorker(worker)) {
    const LeaseRecord& record = state_.leases.At(id);
    if (!record.IsWaiting(now)) continue;
    const int priority = state_.jobs.At(record.lease.unit.job).priority;
    if (least && priority > lowest) continue;
    least = id;
    lowest = priority;
  }
  return least;
}

}  // namespace tessera
