// The scheduler: a pure state machine that decides which worker renders which unit when. Each call is an
// event with the time it happens; decisions are fetched as values. Same calls, same decisions. Not thread
// safe: one thread calls it. Numbers it decides by: policy.h. Rules: DESIGN.md section 6.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/core/counters.h"
#include "coordinator/core/instant.h"
#include "coordinator/core/occupancy.h"
#include "coordinator/core/policy.h"
#include "coordinator/core/records.h"
#include "proto/terms.h"

namespace tessera {

struct SchedulerOptions {
  // Differs for every process that works on a data directory, so that lease ids never meet again.
  uint32_t epoch = 1;
  // Different workers that may fail a unit before its job fails.
  int attempts_max = kAttemptsMaxDefault;
};

class Scheduler {
 public:
  explicit Scheduler(SchedulerOptions options);
  ~Scheduler();

  // ---- Jobs ----
  // Frames in `finished_frames` are not rendered. `extended` is what the job has become since it was
  // submitted as `spec`; of frames in `kept` so many samples per pixel are done.
  void AddJob(JobId id, std::shared_ptr<const JobSpec> spec, const std::set<uint32_t>& finished_frames,
              std::shared_ptr<const JobSpec> extended = nullptr,
              const std::map<uint32_t, uint32_t>& kept = {});
  // Frames have more samples per pixel from now on, as in `spec`, which is otherwise the job's. Finished ones
  // are rendered on: so many samples per pixel of them are done as `kept` says.
  void ExtendJob(JobId id, std::shared_ptr<const JobSpec> spec, const std::map<uint32_t, uint32_t>& kept);
  // Samples that a former process has accepted.
  void RestoreDone(JobId id, uint32_t frame, TileSamples samples);
  // Its leases are void, their holders told to stop. Nothing if there is no such job.
  void RemoveJob(JobId id);
  // While paused nothing of the job is leased; its leases that wait are taken back, those that run may
  // finish.
  void SetPaused(Instant now, JobId id, bool paused);
  // Leases of lower jobs that wait give way to it, those that run do not.
  void SetPriority(JobId id, int priority);
  struct CondemnedJob {
    JobId job{};
    std::string reason;
  };
  // Jobs with a unit that no worker can do, since last asked. The caller removes them.
  std::vector<CondemnedJob> TakeCondemned();

  // ---- Workers ----
  // A worker said what it has and does: leases it holds are renewed, unknown ones taken over or to be
  // dropped.
  void Synchronize(Instant now, const WorkerState& state);
  // The worker's connection broke, or it said goodbye: its leases return.
  void Disconnect(Instant now, WorkerId worker);

  // From now on it gets nothing new, and finishes what it holds.
  void Drain(WorkerId worker);
  // Ends a drain and a quarantine; what the worker has failed is forgiven.
  void Release(WorkerId worker);
  // Who is kept from work, and why; nothing any more if both are empty.
  struct Bar {
    WorkerId worker{};
    std::string name;
    bool drained = false;
    std::string quarantine;
  };
  // Bars that were set or lifted since last asked.
  std::vector<Bar> TakeBars() { return std::exchange(bars_, {}); }
  // All that hold now.
  std::vector<Bar> Bars() const;
  // A bar of a former process.
  void RestoreBar(Instant now, const Bar& bar);

  // ---- Units ----
  // Whether a result can be of this unit: a job, a frame and samples that are open work, in whoever's hands.
  bool IsKnown(const WorkUnit& unit) const;
  // Whether results of the worker count: one that is in quarantine is not believed.
  bool IsTrusted(WorkerId worker) const;
  PixelBounds Bounds(const WorkUnit& unit) const;  // of a known unit's tile
  // A correct result of a known unit came in: true if it was new. `render_seconds` is the worker's
  // measurement.
  bool Finish(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit, double render_seconds);
  // Whether a result of a known unit is not believed alone: hear it first.
  bool NeedsVerification(const WorkUnit& unit);
  struct Hearing {
    enum class Outcome {
      kHeld,      // another worker must say the same
      kBelieved,  // two workers agree: it may Finish
      kUseless    // the worker has said it before, or the unit is not to be had in this way any more
    };
    Outcome outcome = Outcome::kUseless;
    bool is_new = false;  // the opinion is to be kept
    std::string name;     // of who holds it
  };
  // What the worker's result of the unit is (a digest of its sums). Those that are alone with theirs when two
  // agree are quarantined. If nobody agrees with anybody and none is left to ask, the job is condemned.
  Hearing Hear(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit, double render_seconds,
               const Digest& result);
  // An opinion that was heard before a restart.
  void RestoreOpinion(const WorkUnit& unit, const Opinion& opinion);
  // Workers that were alone in a dispute, since last asked.
  std::vector<WorkerId> TakeDisbelieved() { return std::exchange(disbelieved_, {}); }
  // What the tile of a begun frame wants by now, after its results were merged: opens samples, or makes void
  // the leases beyond its end. Nothing if the frame is complete.
  void SetGoal(JobId job, uint32_t frame, uint32_t tile, const TileGoal& goal);
  // Whether all samples of the frame are done; true for a frame that is not begun only if it was finished
  // before.
  bool IsComplete(JobId job, uint32_t frame) const;
  // Results of the worker brought so many pixel samples that are new.
  void CountAccepted(WorkerId worker, uint64_t pixel_samples, double render_seconds);
  // The worker could not do the unit.
  void FailUnit(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit, const std::string& words);
  // The worker could not load the scene: as if it had failed all of its units, whatever job they are of.
  void FailScene(Instant now, WorkerId worker, const Digest& scene, const std::string& words);
  // The worker returned a wrong result: a failure that also counts against the worker.
  void RefuseResult(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit,
                    const std::string& words);

  // ---- Time and decisions ----
  // Takes back what has expired and hands out what is open. Call it after the events of each batch, and when
  // nothing happens at least every TickInterval().
  void Advance(Instant now);
  Instant TickInterval() const;
  // Whether there is something to tell the worker.
  bool HasNews(WorkerId worker) const;
  // Workers that HasNews may be true for; all others have none.
  const std::set<WorkerId>& news() const { return news_; }
  // What the worker should have and do, besides what its last state listed.
  WorkerDirective TakeDirective(Instant now, WorkerId worker);
  // The part of it that answers to results bring.
  struct Grants {
    std::vector<Lease> leases;
    std::vector<LeaseId> drop;
  };
  Grants TakeGrants(Instant now, WorkerId worker);

  // ---- For people ----
  std::vector<WorkerStatus> Workers(Instant now) const;
  bool IsFull(WorkerId worker) const { return workers_.size() >= kWorkersMax && !workers_.contains(worker); }
  uint32_t WorkersOf(JobId job) const;
  // Why no worker there is can do anything for the job, for people; empty if one can.
  std::string Obstacle(JobId job) const;
  size_t lease_count() const { return leases_.size(); }
  const SlotUse& slot_use() const { return occupancy_.now(); }
  enum class Phase {
    kOpen,     // there are units to hand out
    kTail,     // all are in some worker's hands
    kRendered  // all are done
  };
  Phase PhaseOf(JobId job) const;
  // Of slots, seconds: on units of a job that were given up, since last asked.
  struct GivenUp {
    JobId job{};
    double seconds = 0;
  };
  std::vector<GivenUp> TakeGivenUp();
  // Counts what happens here; the farm and the shell count the rest in the same numbers.
  FarmCounters& counters() { return counters_; }
  const FarmCounters& counters() const { return counters_; }
  // What happened, one "event key=value ..." each, since last asked.
  std::vector<std::string> TakeLog();

 private:
  struct Choice {
    JobRecord* job = nullptr;
    uint32_t frame_index = 0;
    FrameRecord* frame = nullptr;
  };

  // scheduler.cpp: events
  WorkerRecord* FindWorker(WorkerId id);
  JobRecord* FindJob(JobId id);
  FrameRecord* FindFrame(const WorkUnit& unit);
  void DropMoot(uint32_t tile, FrameRecord& frame);
  void Retire(JobId job, uint32_t frame);
  void MeasureSpeed(WorkerRecord& worker, FrameRecord& frame, const WorkUnit& unit, double render_seconds);
  void EndLease(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit);
  void Credit(WorkerRecord& worker, FrameRecord& frame, const WorkUnit& unit, double render_seconds);
  void Strike(Instant now, WorkerId worker, const std::string& reason);
  void Quarantine(WorkerRecord& worker, const std::string& reason);
  void Condemn(JobRecord& job, const std::string& words);
  void CondemnWhatAllFailed(Instant now);
  std::set<WorkerId> AbleFor(const JobRecord& job) const;
  std::string MissingTags(const JobRecord& job) const;
  void Log(std::string line) { log_.push_back(std::move(line)); }

  // scheduler_control.cpp: what people ask for while jobs run
  void Enlist(JobRecord& job);
  void Delist(JobRecord& job);
  void StopWanting(const JobRecord& job);
  void NoteBar(WorkerRecord& worker);
  std::vector<LeaseId> LeasesOf(const JobRecord& job) const;
  void TakeBack(LeaseId id);
  static bool IsWaiting(Instant now, const LeaseRecord& record);
  void Preempt(Instant now);
  void PreemptAt(Instant now, WorkerRecord& worker);
  std::optional<LeaseId> LeastUrgentWaiting(Instant now, const WorkerRecord& worker) const;

  // scheduler_verification.cpp: units that two workers render
  void BeginTrial(FrameRecord& frame, TileSamples samples);
  bool JoinTrial(FrameRecord& frame, TileSamples samples);
  void Disbelieve(WorkerId worker, const std::string& reason);
  void GiveBack(FrameRecord& frame, TileSamples samples);

  // scheduler_workers.cpp: what workers hold
  WorkerRecord& Admit(Instant now, const WorkerState& state);
  void ReconcileLeases(Instant now, WorkerRecord& worker, const WorkerState& state);
  void Renew(Instant now, LeaseRecord& record, const HeldLease& held);
  bool TakeOver(Instant now, WorkerRecord& worker, const HeldLease& held);
  void Expire(Instant now);
  void ForgetWorkers(Instant now);
  void CountSpeed(WorkerRecord& worker);
  void Drop(WorkerRecord& worker, LeaseId lease);
  void Revoke(WorkerRecord& worker, LeaseId lease);

  // scheduler_counting.cpp: what it comes to
  void CountSlots(WorkerRecord& worker);
  void CountGivenUp(const LeaseRecord& record);

  // scheduler_dispatch.cpp: who gets what
  bool HasRoom(const WorkerRecord& worker) const;
  void UpdateHunger(WorkerRecord& worker);
  void ForgetHunger(const WorkerRecord& worker);
  void AnnounceWork() { hungry_.merge(starved_); }
  double QueueSeconds(const WorkerRecord& worker) const;
  void Dispatch(Instant now);
  bool GrantOne(Instant now, WorkerRecord& worker);
  void GrantFrom(Instant now, WorkerRecord& worker, const Choice& choice);
  // Of the jobs whose priority is above `floor`.
  Choice Choose(Instant now, WorkerRecord& worker, std::optional<int> floor);
  Choice ChooseOfJobs(Instant now, WorkerRecord& worker, const std::set<JobId>& jobs);
  Choice ReadyFrame(JobRecord& job, const WorkerRecord& worker);
  void Want(WorkerRecord& worker, const Choice& choice);
  double UnitSeconds(const JobRecord& job) const;
  std::optional<double> OpenCost(const JobRecord& job) const;
  LeaseRecord& Grant(Instant now, WorkerRecord& worker, JobRecord& job, FrameRecord& frame,
                     const WorkUnit& unit, LeaseId id);
  LeaseId NextLease() { return LeaseId{uint64_t{options_.epoch} << 32 | lease_next_++}; }
  void Forget(LeaseId id);
  void Return(LeaseId id);

  // scheduler_frames.cpp: which frames are begun, and who loads them
  uint32_t FramesAbreast(const JobRecord& job) const;
  void Activate(JobRecord& job);
  Choice FrameToLoad(Instant now, JobRecord& job, const WorkerRecord& worker);
  bool MayRender(const FrameRecord& frame, const WorkerRecord& worker) const;
  void CountCrews(Instant now);
  void MeasureLoading(Instant now, WorkerRecord& worker, const Digest& scene);

  // scheduler_prefetch.cpp: what they get ready while they render
  void LoadNextFrame(Instant now, WorkerRecord& worker, const Choice& current);
  std::vector<Digest> PackagesAhead() const;
  void FetchNextJobs(Instant now);

  // scheduler_tail.cpp: what idle workers take from slower ones
  void RelieveTail(Instant now);
  static bool HasStarted(Instant now, const LeaseRecord& record);
  std::vector<LeaseId> SlowestUnits(Instant now, size_t count_max) const;
  enum class Relief {
    kGiven,
    kUnfit,   // the helper cannot do it
    kUseless  // neither it nor any slower one would end it sooner
  };
  Relief Relieve(Instant now, WorkerRecord& helper, LeaseId slow, int idle_slots);
  std::optional<SampleRange> PieceFor(const LeaseRecord& slow, const FrameRecord& frame, double whole_s,
                                      int idle_slots) const;

  SchedulerOptions options_;
  uint64_t lease_next_ = 1;
  std::map<JobId, JobRecord> jobs_;
  std::map<int, std::set<JobId>, std::greater<int>> priorities_;  // of the jobs that are not paused
  std::map<WorkerId, WorkerRecord> workers_;
  std::map<LeaseId, LeaseRecord> leases_;
  std::set<WorkerId> hungry_;   // may work, have room, and there may be something for them
  std::set<WorkerId> starved_;  // may work, have room, and there is nothing for them
  std::set<WorkerId> news_;     // see news()
  std::set<WorkerId> preempt_;  // may hold less urgent work than there is by now
  double total_speed_ = 0;      // slots times speed of the workers that may work
  int total_slots_ = 0;
  FarmCounters counters_;
  Occupancy occupancy_;
  std::vector<GivenUp> given_up_;
  Instant tail_due_{}, expiry_due_{}, crews_due_{}, prefetch_due_{};
  std::map<Digest, size_t> crews_;  // of scenes: workers that have them or load them, as last counted
  std::vector<CondemnedJob> condemned_;
  std::vector<WorkerId> disbelieved_;
  std::vector<Bar> bars_;
  std::vector<std::string> log_;
};

}  // namespace tessera
