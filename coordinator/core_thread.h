// The one thread that owns the farm. Others post events. It applies all that wait, appends their results to
// the spool and their facts to the journal, syncs once and then gives the answers (group commit). While the
// disk refuses, workers wait for their answers and clients get the reason; the sync is retried. Ends of jobs,
// which let space be freed, are then written to the reserve of the journal. No lock is held meanwhile: the
// mutex guards the queue alone.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "coordinator/core/farm.h"
#include "coordinator/core/journal.h"
#include "coordinator/core/schedule/instant.h"
#include "coordinator/core/spool.h"
#include "coordinator/membership/member_board.h"
#include "coordinator/open_jobs.h"
#include "coordinator/picture_writer.h"

namespace tessera {

// Answers that wait for an event. Belongs to the core thread.
class PendingAnswers {
 public:
  // Receives the directive, or null if the call was cancelled or the coordinator is shutting down.
  using OnDirective = std::function<void(const WorkerDirective*)>;
  // Receives the answer, or null if the coordinator is shutting down before the results are on stable
  // storage.
  using OnResults = std::function<void(const FarmOutput::Results*)>;
  // Receives each new status; `last` if there will be no other, because the job has ended or (status null)
  // the coordinator is shutting down. Returns false if nobody is watching any more.
  using OnStatus = std::function<bool(const JobStatus* status, bool last)>;
  // Whether somebody is still watching: asked at every interval, even while the status does not change.
  using IsWatched = std::function<bool()>;

  void AwaitDirective(CallId call, OnDirective answer) { directives_[call] = std::move(answer); }
  void AwaitResults(CallId call, OnResults answer) { results_[call] = std::move(answer); }
  // Called when all facts that the event caused are on stable storage. Receives an error if the disk refuses
  // them for now (kFailed) or the coordinator is shutting down first (kInterrupted).
  using OnSync = std::function<void(const Result<void>& synced)>;
  void AfterSync(OnSync answer) { after_sync_.push_back(std::move(answer)); }
  void Watch(JobId job, OnStatus watcher, IsWatched is_watched) {
    watchers_.push_back({job, std::move(watcher), std::move(is_watched), {}});
  }
  // The waiting answer of a call that was cancelled or has failed; empty if it was given already.
  OnDirective TakeDirective(CallId call);
  // Forgets the waiting answer of a call that has failed.
  void DropResults(CallId call) { results_.erase(call); }

 private:
  friend class CoreThread;
  struct Watcher {
    JobId job{};
    OnStatus offer;
    IsWatched is_watched;
    std::optional<JobStatus> sent;
  };
  std::map<CallId, OnDirective> directives_;
  std::map<CallId, OnResults> results_;
  std::vector<OnSync> after_sync_;
  std::vector<Watcher> watchers_;
};

struct CoreContext {
  Farm& farm;
  Instant now;
  PendingAnswers& answers;
};

class CoreThread {
 public:
  using Event = std::function<void(CoreContext&)>;

  struct Parts {
    std::unique_ptr<Farm> farm;
    std::unique_ptr<Journal> journal;
    std::unique_ptr<Spool> spool;
    std::unique_ptr<PictureWriter> pictures;
    // Called with each output, on the core thread.
    std::function<void(const FarmOutput&)> on_output = [](const FarmOutput&) {};
    // Called after each failure to write the journal or the spool: to free some space, on another thread.
    std::function<void()> on_storage_failure = [] {};
    // Whether failures to write are for want of space.
    std::function<bool()> is_disk_low = [] { return false; };
  };
  explicit CoreThread(Parts parts);
  ~CoreThread();  // Stop

  // Thread safe. Events are applied in order.
  void Post(Event event);
  // Thread safe.
  const OpenJobs& open_jobs() const { return open_jobs_; }
  // Thread safe.
  const MemberBoard& members() const { return *members_; }
  // For handshakes that may outlast this object.
  std::shared_ptr<const MemberBoard> shared_members() const { return members_; }
  // Thread safe.
  size_t watcher_count() const { return watcher_count_; }
  // From now on no call waits: workers and watchers learn that the coordinator is shutting down. Thread safe.
  void Close();
  // Ends the picture writer, applies what was posted, then ends the thread.
  void Stop();

 private:
  void Run();
  void NoteOpenJobs();
  void NoteOpenJobs(const Fact& fact);
  std::vector<Event> WaitForEvents(Instant patience);
  void Deliver(FarmOutput output);
  void Answer(FarmOutput output);
  Result<void> Sync();
  Result<void> SyncFacts(const Result<void>& synced);
  void Compact();
  void GiveUpSums();
  void Load(FrameId frame);
  void WritePicture(FinishedPicture picture);
  void Abandon();
  void NotifyWatchers(Instant now);
  Instant Patience(Instant now) const;

  Parts parts_;
  OpenJobs open_jobs_;
  const std::shared_ptr<MemberBoard> members_ = std::make_shared<MemberBoard>();
  PendingAnswers answers_;
  std::vector<FarmOutput> unsynced_;  // in order; their answers wait for the disk
  bool has_facts_ = false;            // that are not on stable storage
  bool frees_space_ = false;          // some of them do
  bool closing_ = false;              // of the core thread
  bool wants_space_ = false;          // a picture could not be written
  Instant watchers_due_{};
  Instant sync_due_{}, reserve_due_{}, compact_due_{};

  std::atomic<size_t> watcher_count_ = 0;  // of answers_, for other threads

  std::mutex mutex_;
  std::condition_variable posted_;
  std::vector<Event> events_;  // guarded by mutex_
  bool stopping_ = false;      // guarded by mutex_
  std::thread thread_;
};

}  // namespace tessera
