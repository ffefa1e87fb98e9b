// The farm: jobs from submission to the last pixel. Joins the scheduler (who renders what) with the mergers
// (what came back) and says what must survive. Pure: calls are events, with the time; what is to be done
// about them is taken out with TakeOutput after Advance. Not thread safe: one thread calls it.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/fact.h"
#include "coordinator/core/instant.h"
#include "coordinator/core/kept_sums.h"
#include "coordinator/core/scheduler.h"
#include "coordinator/core/spool.h"
#include "proto/terms.h"
#include "renderer/film/merger.h"
#include "renderer/film/radiance_tile.h"
#include "renderer/util/result.h"

namespace tessera {

// Names a call that waits for its answer, drawn by the caller.
enum class CallId : uint64_t {};

struct ReturnedUnit {
  LeaseId lease{};
  WorkUnit unit;
  double render_seconds = 0;
  Result<RadianceTile> tile{Failed("no tile")};  // or what is wrong with its bytes
};

struct FinishedPicture {
  JobId job{};
  uint32_t frame = 0;
  std::shared_ptr<const JobSpec> spec;
  FrameSnapshot snapshot;  // to be painted off the deciding thread
};

// What to do after a batch of events, in this order: put `accepted` into the spool and the facts into the
// journal, sync both, spool first; then the rest.
struct FarmOutput {
  struct Accepted {
    FrameId frame;
    TileNode node;
  };
  struct Sums {
    FrameId frame;
    std::vector<TileNode> nodes;
  };
  struct Directive {
    CallId call{};
    WorkerDirective directive;
  };
  struct Results {
    CallId call{};
    std::vector<Verdict> verdicts;
    std::vector<std::string> reasons;  // of the refused
    Scheduler::Grants grants;
  };
  std::vector<Accepted> accepted;
  std::vector<Fact> facts;
  std::vector<Sums> sums;  // of frames that are complete: replace in the spool what was accepted of them
  std::vector<FrameId> dropped;  // from the spool
  std::vector<FrameId> loads;    // from the spool; then call SumsLoaded
  std::vector<JobId> forgotten;  // their pictures may go
  std::vector<Directive> directives;
  std::vector<Results> results;
  std::vector<FinishedPicture> pictures;  // to be written to files; then call PictureWritten
  std::vector<std::string> log;           // "event key=value ..."
};

// Of the sums of finished frames: some 500 frames of 1920 x 1080 pixels, and little for a farm's disk.
constexpr uint64_t kKeptBytesMaxDefault = uint64_t{16} << 30;

class Farm {
 public:
  // Sums of finished frames are kept up to `kept_bytes_max`, so that they can be extended.
  explicit Farm(SchedulerOptions options, uint64_t kept_bytes_max = kKeptBytesMaxDefault);

  // ---- After a start: all facts of former processes in order; what is in the spool; then Begin ----
  void Restore(const Fact& fact);
  // What to do with a frame that is in the spool; `begun` if results of it came in since its last base.
  // kRestore: hand all its nodes to RestoreNode.
  enum class SpoolUse { kDrop, kKeep, kRestore };
  SpoolUse FoundInSpool(FrameId frame, bool begun);
  void RestoreNode(FrameId frame, TileNode node);
  void Begin(Instant now);
  // Facts that lead to the state of now: they may take the place of all before.
  std::vector<Fact> Snapshot() const;

  // ---- Workers (proto/work.proto) ----
  // Whether the worker may join; the error says why not.
  Result<void> CheckAdmission(const WorkerState& state) const;
  // Answered in some later output: when there is news for the worker, at the latest after the wait it asked
  // for.
  void Synchronize(Instant now, CallId call, const WorkerState& state);
  // The other end of a waiting call is gone, so the worker is: the call will not be answered.
  void Cut(Instant now, CallId call);
  // Answered in the next output.
  void ReturnResults(Instant now, CallId call, WorkerId worker, std::vector<ReturnedUnit> units);
  // The worker could not do a unit or load a scene, in its own words.
  void FailUnit(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit, const std::string& words);
  void FailScene(Instant now, WorkerId worker, const Digest& scene, const std::string& words);

  // ---- Clients (proto/jobs.proto) ----
  // A job of the same submission number is answered again. May be told to the client once the output is
  // journalled.
  Result<JobId> Submit(Instant now, std::shared_ptr<const JobSpec> spec);
  Result<JobStatus> Cancel(Instant now, JobId job);
  // Every frame of the job gets so many samples per pixel; what is done stays done. The error says why not.
  Result<JobStatus> Extend(Instant now, JobId job, uint32_t samples_per_pixel);
  // Whether a picture of the job is on its way to its file, or sums on theirs from the spool. Extend must
  // wait for that.
  bool IsMovingSums(JobId job) const;
  // As it is now: submitted, or extended since. Null if there is no such job.
  std::shared_ptr<const JobSpec> Spec(JobId job) const;
  // Of open jobs only. What is so already stays so.
  Result<JobStatus> SetPaused(Instant now, JobId job, bool paused);
  Result<JobStatus> SetPriority(Instant now, JobId job, int32_t priority);
  std::optional<JobStatus> Status(Instant now, JobId job) const;
  std::vector<JobStatus> Jobs(Instant now) const;
  std::vector<WorkerStatus> Workers(Instant now) const { return scheduler_.Workers(now); }
  // The job's frames in order; empty if there is no such job.
  std::vector<FrameStatus> Frames(JobId job) const;
  // Scene packages of all open jobs.
  std::vector<Digest> PackagesInUse() const;
  // Those of a name, or the one whose number is `which` in 16 hexadecimal digits.
  std::vector<WorkerStatus> FindWorkers(Instant now, const std::string& which) const;
  void Drain(WorkerId worker) { scheduler_.Drain(worker); }
  void Release(WorkerId worker) { scheduler_.Release(worker); }
  // The frame's file, if it is written.
  std::optional<Digest> FinishedFile(JobId job, uint32_t frame) const;
  // What is there of a frame that is being rendered; nothing if it is complete, its job has ended or there is
  // none.
  std::optional<FinishedPicture> Preview(JobId job, uint32_t frame) const;

  // ---- Files ----
  void PictureWritten(Instant now, JobId job, uint32_t frame, const Digest& file);
  // Writing failed and will be tried again: shown as the reason of a pause.
  void PictureDelayed(JobId job, const std::string& reason);
  // Journal or spool cannot be written for this reason, which all open jobs show; none: they can.
  void StorageDelayed(const std::string& reason);
  // All nodes of a frame that is being rendered, to replace what the spool has of it. Nothing if the frame is
  // not, or if some are still in the spool alone.
  std::optional<std::vector<TileNode>> Sums(FrameId frame) const;
  void SumsLoaded(Instant now, FrameId frame, Result<std::vector<TileNode>> nodes);

  // ---- Time ----
  // Call after each batch of events, and again after at most Patience().
  void Advance(Instant now);
  Instant Patience(Instant now) const;
  FarmOutput TakeOutput();

  const Scheduler& scheduler() const { return scheduler_; }
  // What was counted since the start. The shell adds to the coordinator's own times.
  FarmCounters& counters() { return scheduler_.counters(); }
  const FarmCounters& counters() const { return scheduler_.counters(); }

 private:
  struct Progress {
    Instant at{};
    uint64_t samples = 0;
  };
  // The moments that cut the time of a job into parts, as the counters stood then.
  struct JobClock {
    FarmCounters begun, tail, rendered, ended;
    Scheduler::Phase phase = Scheduler::Phase::kOpen;
    double render_s = 0, waste_s = 0;  // of slots, on this job
  };
  struct JobEntry {
    JobId id{};
    std::shared_ptr<const JobSpec> submitted;
    std::shared_ptr<const JobSpec> spec;  // as submitted, or extended since
    JobState state = JobState::kWaiting;
    std::string reason;
    bool paused = false;  // by the user
    int32_t priority = 0;
    std::map<WorkUnit, std::vector<Opinion>> opinions;  // of units that are verified and not decided
    std::map<WorkerId, uint64_t> unconfirmed;           // units merged of each worker, if some are verified
    uint64_t units_verified = 0, units_disputed = 0, units_suspect = 0;
    Instant began{}, ended{};
    uint64_t samples_done = 0, samples_total = 0;
    uint64_t samples_accepted = 0;       // by this process, those that were there before included
    std::deque<Progress> progress;       // of the last seconds
    std::map<uint32_t, Merger> mergers;  // of frames begun and not complete
    std::map<uint32_t, Digest> files;    // of frames written
    std::map<uint32_t, uint64_t> taken;  // pixel samples of frames complete
    std::set<uint32_t> writing;          // complete, not written
    std::map<uint32_t, uint32_t> kept;   // not begun: samples per pixel that are in the spool alone
    std::set<uint32_t> loading;          // begun, those samples are on their way from the spool
    JobClock clock;
  };
  struct Parked {
    CallId call{};
    Instant until{};
  };
  struct PendingResults {
    CallId call{};
    WorkerId worker{};
    std::vector<Verdict> verdicts;
    std::vector<std::string> reasons;
  };

  // farm_recovery.cpp
  void ResumeJob(Instant now, JobEntry& job);
  void RestoreWork(JobId id, uint32_t frame, const Merger& merger);
  void RestoreKept();
  void RestoreExtension(JobEntry& job, uint32_t samples_per_pixel);
  void AppendHistory(const JobEntry& job, std::vector<Fact>& facts) const;

  // farm_extend.cpp
  Result<void> CheckExtension(const JobEntry& job, uint32_t samples_per_pixel) const;
  void ExtendFrames(JobEntry& job, std::shared_ptr<const JobSpec> spec);
  void KeepSums(const JobEntry& job, uint32_t frame);
  bool MayKeep(const JobEntry& job) const;

  JobEntry& AddJob(JobId id, std::shared_ptr<const JobSpec> spec);
  JobEntry* FindJob(JobId id);
  const JobEntry* FindJob(JobId id) const;
  Result<JobEntry*> FindOpenJob(JobId id, const char* verb);
  void EndJob(Instant now, JobEntry& job, JobState state, const std::string& reason);
  void ForgetEnded();
  void Count(JobEntry& job, const OpinionHeard& heard);
  void RestoreControl(const Fact& fact);
  void AppendControl(const JobEntry& job, std::vector<Fact>& facts) const;
  static UnitsCounted CountsOf(const JobEntry& job);
  static WorkerBarred FactOf(const Scheduler::Bar& bar);
  std::optional<Verdict> Verify(Instant now, JobEntry& job, WorkerId worker, const ReturnedUnit& returned);
  void NoteBars();
  void NoteSuspects();
  Verdict Accept(Instant now, WorkerId worker, ReturnedUnit& unit, std::string& reason);
  void Merge(JobEntry& job, const WorkUnit& unit, RadianceTile tile);
  Merger& MergerOf(JobEntry& job, uint32_t frame);
  bool IsEarly(JobEntry& job, const WorkUnit& unit);
  std::string Mismatch(JobEntry& job, const WorkUnit& unit, const RadianceTile& tile);
  void CompleteFrame(JobEntry& job, uint32_t frame);
  void DropSums(const JobEntry& job);
  JobStatus StatusOf(Instant now, const JobEntry& job) const;
  // farm_report.cpp: where the time went
  JobTimes TimesOf(const JobEntry& job) const;
  void CountResult(Verdict verdict, const ReturnedUnit& returned);
  void CountGivenUp();
  void MeasurePhase(JobEntry& job);
  void MeasureProgress(Instant now);
  void AnswerParked(Instant now);
  void Answer(Instant now, WorkerId worker);
  void Unpark(WorkerId worker);

  Scheduler scheduler_;
  std::map<JobId, JobEntry> jobs_;
  std::map<uint64_t, JobId> submissions_;
  std::set<JobId> open_jobs_;
  std::vector<WorkerBarred> former_bars_;  // between Restore and Begin
  uint64_t job_next_ = 1;
  uint32_t epoch_;
  KeptSums kept_sums_;
  std::string storage_reason_;  // why nothing can be kept now, or empty
  // Until Begin.
  std::vector<FrameId> finished_;  // in the order they were
  std::set<FrameId> found_kept_;   // in the spool
  std::map<WorkerId, Parked> parked_;
  std::map<CallId, WorkerId> parked_calls_;
  std::set<std::pair<Instant, WorkerId>> parked_until_;
  std::vector<PendingResults> pending_results_;
  FarmOutput output_;
};

}  // namespace tessera
