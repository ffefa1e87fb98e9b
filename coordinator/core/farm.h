// The farm: jobs from submission to the last pixel. Pure: calls are events with the time they happen; what is
// to be done about them is taken out with TakeOutput after Advance. Not thread safe: one thread calls it.
//
// A thin front of its parts, one file each: the scheduler (who renders what), result acceptance (what came
// back), frame completion (pictures and sums), job extension, job end, recovery, and reports for people. They
// share FarmState.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/farm_recovery.h"
#include "coordinator/core/farm_state.h"
#include "coordinator/core/frame_completion.h"
#include "coordinator/core/job_end.h"
#include "coordinator/core/job_extension.h"
#include "coordinator/core/parked_calls.h"
#include "coordinator/core/preparations.h"
#include "coordinator/core/result_acceptance.h"

namespace tessera {

// Limit for the sums of finished frames: some 500 frames of 1920 x 1080 pixels, and little for a farm's disk.
constexpr uint64_t kKeptBytesMaxDefault = uint64_t{16} << 30;

class Farm {
 public:
  // Sums of finished frames are kept up to `kept_bytes_max`, so that they can be extended.
  explicit Farm(SchedulerOptions options, uint64_t kept_bytes_max = kKeptBytesMaxDefault, FarmId id = {});
  FarmId id() const { return state_.id; }

  // ---- After a start: all facts of former processes in order; what is in the spool; then Begin ----
  using SpoolUse = tessera::SpoolUse;
  void Restore(const Fact& fact) { recovery_.Restore(fact); }
  SpoolUse FoundInSpool(FrameId frame, bool begun) { return recovery_.FoundInSpool(frame, begun); }
  void RestoreNode(FrameId frame, TileNode node) { recovery_.RestoreNode(frame, std::move(node)); }
  // `since_1970`: the time of day, which counts in facts alone.
  void Begin(Instant now, std::chrono::milliseconds since_1970 = {}) {
    state_.since_1970 = since_1970 - std::chrono::duration_cast<std::chrono::milliseconds>(now);
    recovery_.Begin(now);
    preparations_.Begin();
  }
  // Facts that lead to the present state: they may take the place of all before.
  std::vector<Fact> Snapshot() const { return recovery_.Snapshot(); }

  // ---- Workers (proto/work.proto) ----
  // The error says why the worker can never join.
  Result<void> CheckAdmission(const WorkerState& state) const;
  // Why the worker cannot join now, or empty: it should try again later.
  std::string WhyNoPlace(WorkerId worker) const;
  // Whether the worker has sent its state to this process: before that nothing that it returns is accepted.
  bool HasJoined(WorkerId worker) const { return state_.scheduler.MemberOf(worker).has_value(); }
  // Whose certificate the worker has, 0 if it has none. Returns nullopt if it has not joined.
  std::optional<MemberId> MemberOf(WorkerId worker) const { return state_.scheduler.MemberOf(worker); }
  // Answered in some later output: when there is news for the worker, at the latest after the wait it asked
  // for. A worker that comes from another farm, or from none, is answered in the next.
  void Synchronize(Instant now, CallId call, WorkerState state);
  // The other end of a waiting call is gone, so the worker is: the call will not be answered.
  void Cut(Instant now, CallId call);
  // Answered in the next output.
  void ReturnResults(Instant now, CallId call, WorkerId worker, std::vector<ReturnedUnit> units);
  // The worker could not render a unit or load a scene of this farm, for the reason it gives.
  void FailUnit(WorkerId worker, LeaseId lease, const WorkUnit& unit, const std::string& reason);
  void FailScene(WorkerId worker, const Digest& scene, const std::string& reason,
                 FailureCause cause = FailureCause::kScene);

  // The worker has prepared a scene of this farm, or could not.
  void ReturnPreparation(Instant now, WorkerId worker, const PreparationReport& report) {
    preparations_.Return(now, worker, report);
  }

  // ---- Clients (proto/jobs.proto) ----
  // Returns the known id if the owner has submitted a job with the same submission number. The client may be
  // told once the output is journalled. kBadInput: the number is that of another owner's job.
  Result<JobId> Submit(Instant now, std::shared_ptr<const JobSpec> spec, const JobOwner& owner = {});
  // The same for a job whose frames a worker is to make.
  Result<JobId> Order(Instant now, std::shared_ptr<const JobOrder> order, const JobOwner& owner = {});
  // Returns nullptr if there is no such job.
  const JobOwner* OwnerOf(JobId job) const;
  Result<JobStatus> Cancel(Instant now, JobId job);
  // Every frame of the job gets this many samples per pixel; what is done stays done. The error says why not.
  Result<JobStatus> Extend(Instant now, JobId job, uint32_t samples_per_pixel);
  // Whether a picture of the job is on its way to its file or sums are on theirs from the spool. Extend must
  // wait for that.
  bool IsMovingSums(JobId job) const;
  // As it is now: submitted, or extended since. Returns nullptr if there is no such job.
  std::shared_ptr<const JobSpec> Spec(JobId job) const;
  // Of open jobs only. Setting what is set already is no error.
  Result<JobStatus> SetPaused(Instant now, JobId job, bool paused);
  Result<JobStatus> SetPriority(Instant now, JobId job, int32_t priority);
  std::optional<JobStatus> Status(Instant now, JobId job) const;
  std::vector<JobStatus> Jobs(Instant now) const;
  std::vector<WorkerStatus> Workers(Instant now) const { return state_.scheduler.Workers(now); }
  // The job's frames in order; empty if there is no such job.
  std::vector<FrameStatus> Frames(JobId job) const;
  // Whether no worker can render the frame.
  bool HasFailed(FrameId frame) const;
  // Scene packages of all open jobs.
  std::vector<Digest> PackagesInUse() const;
  // Workers of a name, or the one whose id is `which` in 16 hexadecimal digits.
  std::vector<WorkerStatus> FindWorkers(Instant now, const std::string& which) const;
  void Drain(WorkerId worker) { state_.scheduler.Drain(worker); }
  void Release(WorkerId worker) { state_.scheduler.Release(worker); }
  // What the frame is rendered from; nullopt if there is no such frame.
  std::optional<Digest> SceneOf(FrameId frame) const;
  // The frame's file if it was written.
  std::optional<PictureFile> FinishedFile(JobId job, uint32_t frame) const;
  // All files that were written, of the jobs that are known.
  std::vector<std::pair<FrameId, PictureFile>> FinishedFiles() const;
  std::optional<FinishedPicture> Preview(JobId job, uint32_t frame) const {
    return frames_.Preview(job, frame);
  }

  // ---- Members (proto/access.proto) ----
  MembershipLedger& membership() { return state_.membership; }
  const MembershipLedger& membership() const { return state_.membership; }

  // ---- Files ----
  // Each picture of an output was either written or could not be; then it comes again in a later output.
  void PictureWritten(Instant now, FrameId frame, const PictureFile& file) {
    frames_.PictureWritten(now, frame, file);
  }
  void PictureDelayed(Instant now, FrameId frame, const std::string& reason) {
    frames_.PictureDelayed(now, frame, reason);
  }
  // The picture that PictureWritten names next is noisy, although its frame is to be denoised.
  void PictureNotDenoised(FrameId frame, const std::string& reason) {
    frames_.PictureNotDenoised(frame, reason);
  }
  // The file of a finished frame is damaged or missing. Returns nullopt if it is made again from its sums,
  // otherwise why it is lost and what to do.
  std::optional<std::string> PictureDamaged(FrameId frame, const std::string& reason);
  // The file of a finished frame was read and is as it was written.
  void PictureIntact(FrameId frame) { frames_.PictureIntact(frame); }
  // Why the journal or the spool cannot be written, which all open jobs show; empty if they can.
  void StorageDelayed(const std::string& reason);
  const std::string& storage_reason() const { return state_.storage_reason; }
  // Forgets the sums of some finished frames, those that were finished first, except `needed`. They may be
  // dropped from the spool immediately, for want of space.
  std::vector<FrameId> GiveUpSums(const std::set<FrameId>& needed);
  // All nodes of a frame that is being rendered, to replace what the spool has of it.
  std::optional<std::vector<TileNode>> Sums(FrameId frame) const { return frames_.Sums(frame); }
  void SumsLoaded(Instant now, FrameId frame, Result<std::vector<TileNode>> nodes) {
    frames_.SumsLoaded(now, frame, std::move(nodes));
  }

  // ---- Time ----
  // Call after each batch of events, and again after at most Patience().
  void Advance(Instant now);
  Instant Patience(Instant now) const;
  FarmOutput TakeOutput();

  const Scheduler& scheduler() const { return state_.scheduler; }
  // What was counted since the start. The shell adds the coordinator's own times.
  FarmCounters& counters() { return state_.scheduler.counters(); }
  const FarmCounters& counters() const { return state_.scheduler.counters(); }

 private:
  // The job that was submitted with this number, or why another job cannot be taken; nullopt: it can be.
  std::optional<Result<JobId>> FindOrRefuse(uint64_t submission, const JobOwner& owner, uint64_t bytes) const;
  struct PendingResults {
    CallId call{};
    WorkerId worker{};
    std::vector<Verdict> verdicts;
    std::vector<std::string> reasons;
  };
  // The jobs and frames that failed.
  void EndFailed(Instant now);
  void AnswerResults(Instant now);
  void AnswerParked(Instant now);
  void Answer(Instant now, WorkerId worker);
  void PushDirective(CallId call, WorkerDirective directive);
  void Log(std::string line) { state_.output.log.push_back(std::move(line)); }

  FarmState state_;
  JobEnd end_;
  FrameCompletion frames_;
  ResultAcceptance results_;
  JobExtension extension_;
  Preparations preparations_;
  FarmRecovery recovery_;
  ParkedCalls parked_;
  std::vector<PendingResults> pending_results_;
};

}  // namespace tessera
