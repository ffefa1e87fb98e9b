// Decides which worker gets which unit next. Owned by the scheduler.
#pragma once

#include <functional>
#include <optional>
#include <set>

#include "coordinator/core/schedule/lease_control.h"
#include "coordinator/core/schedule/scene_locality.h"
#include "coordinator/core/schedule/suspect_trials.h"

namespace tessera {

class Dispatcher {
 public:
  Dispatcher(ScheduleState& state, LeaseControl& leases, SceneLocality& scenes, SuspectTrials& trials)
      : state_(state), leases_(leases), scenes_(scenes), trials_(trials) {}

  // Gives leases to all workers that have room, as far as there is work for them.
  void Dispatch(Instant now);
  // Units that wait at a worker give way to more urgent ones, one for one. Looks only at workers that were
  // marked.
  void Preempt(Instant now);
  // The worker may hold less urgent work than there is by now.
  void MarkForPreemption(WorkerId worker) { preempt_.insert(worker); }
  // A job became runnable or more urgent.
  void AnnounceJob();

 private:
  bool GrantOne(Instant now, WorkerRecord& worker);
  bool GrantTrial(Instant now, WorkerRecord& worker, const SuspectTrials::Trial& trial);
  using MayRender = std::function<bool(uint32_t tile)>;
  void GrantFrom(Instant now, WorkerRecord& worker, const FrameChoice& choice, const MayRender& may);
  void GrantFrom(Instant now, WorkerRecord& worker, const FrameChoice& choice);
  FrameChoice Choose(Instant now, WorkerRecord& worker, std::optional<int> above_priority);
  FrameChoice ChooseByPriority(Instant now, WorkerRecord& worker, std::optional<int> above_priority);
  bool BeginFor(const WorkerRecord& worker);
  // Whether an active frame that others work on may have units for the worker later.
  bool MayHelpLater(const WorkerRecord& worker) const;
  bool MayExceedFor(const WorkerRecord& worker) const;
  FrameChoice ChooseAmong(Instant now, WorkerRecord& worker, const std::set<JobId>& jobs);
  void PreemptAt(Instant now, WorkerRecord& worker);
  std::optional<LeaseId> LeastUrgentWaiting(Instant now, WorkerId worker) const;

  ScheduleState& state_;
  LeaseControl& leases_;
  SceneLocality& scenes_;
  SuspectTrials& trials_;
  std::set<WorkerId> preempt_;
};

}  // namespace tessera
