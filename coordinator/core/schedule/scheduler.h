// The scheduler: a pure state machine that decides which worker renders which unit when. Each call is an
// event with the time it happens; decisions are fetched as values. Same calls, same decisions. Not thread
// safe: one thread calls it.
//
// It conducts its parts, one file each: the lease table, the worker roster, the job queue and idle workers
// hold what is known (schedule_state.h); lease control, scene locality, dispatcher, tail relief, failure
// handling, trials of suspects, vote counting and worker sync change it. The numbers it decides by are in
// policy.h.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/core/schedule/dispatcher.h"
#include "coordinator/core/schedule/failure_handling.h"
#include "coordinator/core/schedule/lease_control.h"
#include "coordinator/core/schedule/scene_locality.h"
#include "coordinator/core/schedule/schedule_state.h"
#include "coordinator/core/schedule/suspect_trials.h"
#include "coordinator/core/schedule/tail_relief.h"
#include "coordinator/core/schedule/unit_completion.h"
#include "coordinator/core/schedule/vote_counting.h"
#include "coordinator/core/schedule/worker_sync.h"

namespace tessera {

struct SchedulerOptions {
  // Grows with every process that works on a data directory.
  uint32_t epoch = 1;
  // Different workers that may fail a unit before its frame fails.
  int attempts_max = kAttemptsMaxDefault;
  // Random: lease ids of different processes never meet.
  uint64_t session = 0;
};

class Scheduler {
 public:
  explicit Scheduler(SchedulerOptions options);

  // Where only the call is handed on, the part's header has the contract.

  // ---- Jobs ----
  // The job is open from now on, all frames except those in `finished`. The record must stay where it is
  // until RemoveJob.
  void AddJob(Job& job, const std::set<uint32_t>& finished = {});
  // Frames of the job have more samples per pixel from now on: `spec` takes the place of the job's. Finished
  // frames are rendered on.
  void ExtendJob(Job& job, std::shared_ptr<const JobSpec> spec);
  void RestoreDone(JobId job, uint32_t frame, TileSamples samples) {
    units_.RestoreDone(job, frame, samples);
  }
  // Ends the leases of the job and directs their holders to drop them. Does nothing if the job is not open.
  void RemoveJob(Job& job);
  // The frame is not rendered any more; its leases end as those of RemoveJob do.
  void DropFrame(Job& job, uint32_t frame);
  // While a job is paused nothing of it is leased; leases that wait are taken back, those that run may
  // finish.
  void SetPaused(Instant now, Job& job, bool is_paused);
  // Leases of lower jobs that wait give way to it, those that run do not.
  void SetPriority(Job& job, int priority);
  std::vector<FailedJob> TakeFailedJobs() { return failures_.TakeFailedJobs(); }
  std::vector<FailedFrame> TakeFailedFrames() { return failures_.TakeFailedFrames(); }

  // ---- Workers ----
  void Synchronize(Instant now, const WorkerState& state) { sync_.Synchronize(now, state); }
  // The worker's connection broke.
  void Disconnect(Instant now, WorkerId worker) { sync_.Disconnect(now, worker, Departure::kCut); }
  // From now on the worker gets nothing new and finishes what it holds.
  void Drain(WorkerId worker);
  // Ends a drain and a quarantine and forgives the worker's strikes.
  void Release(WorkerId worker);
  std::vector<WorkerBlock> TakeBlocks() { return state_.workers.TakeBlocks(); }
  std::vector<WorkerBlock> Blocks() const { return state_.workers.Blocks(); }
  void RestoreBlock(Instant now, const WorkerBlock& block) { state_.workers.RestoreBlock(now, block); }
  // Whether results of the worker count: those of a worker in quarantine do not.
  bool IsTrusted(WorkerId worker) const;
  // Whether the worker is in contact.
  bool IsConnected(WorkerId id) const;
  // Whether it may get work.
  bool MayWork(WorkerId id) const;
  // Empty if it is not known.
  std::string NameOf(WorkerId id) const;
  // Workers that may get work, and whose they are.
  std::map<WorkerId, Party> AbleWorkers() const;
  size_t WorkerCount() const { return state_.workers.size(); }
  // Of the workers that may work, the one with the fewest units for its slots; nullopt if there is none
  // besides those excluded.
  std::optional<WorkerId> LeastLoaded(const std::set<WorkerId>& excluded) const;
  // Why no worker may work, for people; empty if some may.
  std::string WhyNoWorker() const;
  bool IsFull(WorkerId worker) const;
  // The member whose certificate the worker has, 0 if it has none. Returns nullopt if the worker has not sent
  // its state to this process.
  std::optional<MemberId> MemberOf(WorkerId worker) const;

  // ---- Results ----
  // Whether the unit can be a part of an open frame, whoever holds it.
  bool IsKnown(const WorkUnit& unit) const { return state_.jobs.IsKnown(unit); }
  // Whether the unit's frame is begun and not complete. Results of others are not wanted yet.
  bool IsBegun(const WorkUnit& unit) { return state_.jobs.FindFrame(unit) != nullptr; }
  // Whether the unit is or was leased to the worker, as far as is known.
  bool MayHaveLeased(WorkerId worker, LeaseId lease, const WorkUnit& unit) const {
    return state_.leases.MayHaveBeen(lease, worker, unit);
  }
  // What of the frame of a known unit that is begun is done and wanted.
  const FrameWork& WorkOf(const WorkUnit& unit) { return state_.jobs.FindFrame(unit)->work; }
  // Where the values of such a unit's result are.
  const ChannelLayout& LayoutOf(const WorkUnit& unit) { return state_.jobs.FindFrame(unit)->layout; }
  // Whether all samples of the frame are done.
  bool IsComplete(const Job& job, uint32_t frame) const;
  bool Finish(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit, double render_seconds) {
    return units_.Finish(now, worker, lease, unit, render_seconds);
  }
  void SetGoal(Job& job, uint32_t frame, uint32_t tile, const TileGoal& goal) {
    units_.SetGoal(job, frame, tile, goal);
  }
  bool NeedsVote(const WorkUnit& unit) { return votes_.NeedsVote(unit); }
  VoteOutcome RecordVote(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit,
                         double render_seconds, const Digest& result) {
    return units_.RecordVote(now, worker, lease, unit, render_seconds, result);
  }
  void RestoreVote(const WorkUnit& unit, const Vote& vote) { votes_.RestoreVote(unit, vote); }
  std::vector<WorkerId> TakeDistrusted() { return votes_.TakeDistrusted(); }
  // A result of the worker brought this many pixel samples that are new.
  void CountAccepted(WorkerId worker, uint64_t pixel_samples, double render_seconds);
  void FailUnit(WorkerId worker, LeaseId lease, const WorkUnit& unit, const std::string& reason) {
    failures_.FailUnit(worker, lease, unit, reason);
  }
  void FailScene(WorkerId worker, const Digest& scene, const std::string& reason,
                 FailureCause cause = FailureCause::kScene) {
    failures_.FailScene(worker, scene, reason, cause);
  }
  void RefuseResult(WorkerId worker, LeaseId lease, const WorkUnit& unit, const std::string& reason) {
    failures_.RefuseResult(worker, lease, unit, reason);
  }

  // ---- Time and decisions ----
  // Decides. Call it after the events of each batch, and at least every TickInterval() if nothing happens.
  void Advance(Instant now);
  Instant TickInterval() const;
  // Whether there is something to tell the worker.
  bool HasNews(WorkerId worker) const { return state_.workers.HasNews(worker); }
  // Workers that HasNews may be true for; all others have none.
  const std::set<WorkerId>& news() const { return state_.workers.news(); }
  // What the worker should have and do, besides what its last state listed.
  WorkerDirective TakeDirective(Instant now, WorkerId worker) { return sync_.TakeDirective(now, worker); }
  LeaseGrants TakeGrants(Instant now, WorkerId worker) { return sync_.TakeGrants(now, worker); }

  // ---- For people ----
  std::vector<WorkerStatus> Workers(Instant now) const;
  uint32_t WorkersOf(JobId job) const;
  // Why no worker can do anything for the job; empty if one can or the job is not open.
  std::string Obstacle(JobId job) const;
  size_t lease_count() const { return state_.leases.size(); }
  const LeaseTable& leases() const { return state_.leases; }
  const SlotUse& slot_use() const { return state_.workers.occupancy().now(); }
  JobPhase PhaseOf(const Job& job) const;
  std::vector<GivenUpTime> TakeGivenUp() { return std::exchange(state_.given_up, {}); }
  // Counts what happens here; the farm and the shell count the rest in the same numbers.
  FarmCounters& counters() { return state_.counters; }
  const FarmCounters& counters() const { return state_.counters; }
  // What happened since the last call, one "event key=value ..." each.
  std::vector<std::string> TakeLog() { return std::exchange(state_.log, {}); }
  std::vector<JobMessage> TakeMessages() { return std::exchange(state_.messages, {}); }

 private:
  void Unblock(WorkerRecord& worker);

  ScheduleState state_;
  LeaseControl leases_;
  SceneLocality scenes_;
  FailureHandling failures_;
  SuspectTrials trials_;
  Dispatcher dispatcher_;
  TailRelief tail_;
  VoteCounting votes_;
  UnitCompletion units_;
  WorkerSync sync_;
  Instant expiry_due_{};
  bool is_first_;                 // process that works on the data directory
  std::optional<Instant> begun_;  // the first Advance
};

}  // namespace tessera
