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

#include "core/fact.h"
#include "core/instant.h"
#include "core/scheduler.h"
#include "film/merger.h"
#include "film/radiance_tile.h"
#include "terms/terms.h"
#include "util/result.h"

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
  FramePicture picture;
};

// What to do after a batch of events, in this order: journal the facts, sync, then the rest.
struct FarmOutput {
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
  std::vector<Fact> facts;
  std::vector<Directive> directives;
  std::vector<Results> results;
  std::vector<FinishedPicture> pictures;  // to be written to files; then call PictureWritten
  std::vector<std::string> log;           // "event key=value ..."
};

class Farm {
 public:
  explicit Farm(SchedulerOptions options);

  // ---- After a start: all facts of former processes in order, then Begin ----
  void Restore(const Fact& fact);
  void Begin(Instant now);

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
  std::optional<JobStatus> Status(Instant now, JobId job) const;
  std::vector<JobStatus> Jobs(Instant now) const;
  std::vector<WorkerStatus> Workers(Instant now) const { return scheduler_.Workers(now); }
  // The frame's file, if it is written.
  std::optional<Digest> FinishedFile(JobId job, uint32_t frame) const;
  // What is there of a frame that is being rendered; nothing if it is complete, its job has ended or there is
  // none.
  std::optional<FinishedPicture> Preview(JobId job, uint32_t frame) const;

  // ---- Files ----
  void PictureWritten(Instant now, JobId job, uint32_t frame, const Digest& file);
  // Writing failed and will be tried again: shown as the reason of a pause.
  void PictureDelayed(JobId job, const std::string& reason);

  // ---- Time ----
  // Call after each batch of events, and again after at most Patience().
  void Advance(Instant now);
  Instant Patience(Instant now) const;
  FarmOutput TakeOutput();

  const Scheduler& scheduler() const { return scheduler_; }

 private:
  struct Progress {
    Instant at{};
    uint64_t samples = 0;
  };
  struct JobEntry {
    JobId id{};
    std::shared_ptr<const JobSpec> spec;
    JobState state = JobState::kWaiting;
    std::string reason;
    Instant began{}, ended{};
    uint64_t samples_done = 0, samples_total = 0;
    std::deque<Progress> progress;       // of the last seconds
    std::map<uint32_t, Merger> mergers;  // of frames begun and not complete
    std::map<uint32_t, Digest> files;    // of frames written
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

  JobEntry& AddJob(JobId id, std::shared_ptr<const JobSpec> spec);
  JobEntry* FindJob(JobId id);
  const JobEntry* FindJob(JobId id) const;
  void EndJob(Instant now, JobEntry& job, JobState state, const std::string& reason);
  void ForgetEnded();
  Verdict Accept(Instant now, WorkerId worker, ReturnedUnit& unit, std::string& reason);
  void Merge(JobEntry& job, const WorkUnit& unit, RadianceTile tile);
  JobStatus StatusOf(Instant now, const JobEntry& job) const;
  void MeasureProgress(Instant now);
  void AnswerParked(Instant now);
  void Answer(Instant now, WorkerId worker, CallId call);

  Scheduler scheduler_;
  std::map<JobId, JobEntry> jobs_;
  std::map<uint64_t, JobId> submissions_;
  std::set<JobId> open_jobs_;
  uint64_t job_next_ = 1;
  std::map<WorkerId, Parked> parked_;
  std::map<CallId, WorkerId> parked_calls_;
  std::vector<PendingResults> pending_results_;
  FarmOutput output_;
};

}  // namespace tessera
