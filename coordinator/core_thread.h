// The one thread that owns the farm. Others post events; it applies all that wait, puts the results among
// them into the spool and their facts into the journal, syncs once and then gives the answers (group commit).
// While the disk refuses, nothing is answered: all of it waits, and is tried again. No lock is held
// meanwhile: the mutex guards the queue alone.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "coordinator/core/farm.h"
#include "coordinator/core/instant.h"
#include "coordinator/core/journal.h"
#include "coordinator/core/spool.h"

namespace tessera {

// Answers that wait for their time. Belongs to the core thread.
class PendingAnswers {
 public:
  // Gets the directive, or nothing if the call was cut or the coordinator ends.
  using OnDirective = std::function<void(const WorkerDirective*)>;
  // Gets the answer, or nothing if the coordinator ends before it could keep what it should.
  using OnResults = std::function<void(const FarmOutput::Results*)>;
  // Gets each new status; `last` if there will be no other: the job has ended or (status null) the
  // coordinator ends. Answers false if nobody watches any more.
  using OnStatus = std::function<bool(const JobStatus* status, bool last)>;

  void AwaitDirective(CallId call, OnDirective answer) { directives_[call] = std::move(answer); }
  void AwaitResults(CallId call, OnResults answer) { results_[call] = std::move(answer); }
  // Gets true when everything that the event caused is on stable storage; false if the coordinator ends
  // before.
  using OnSync = std::function<void(bool synced)>;
  void AfterSync(OnSync answer) { after_sync_.push_back(std::move(answer)); }
  void Watch(JobId job, OnStatus watcher) { watchers_.push_back({job, std::move(watcher), {}}); }
  // The waiting answer of a call that is cut; empty if it was given already.
  OnDirective TakeDirective(CallId call);

 private:
  friend class CoreThread;
  struct Watcher {
    JobId job{};
    OnStatus offer;
    std::optional<JobStatus> told;
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

  // What it owns, and what it has others do, who must not block.
  struct Parts {
    std::unique_ptr<Farm> farm;
    std::unique_ptr<Journal> journal;
    std::unique_ptr<Spool> spool;
    std::function<void(FinishedPicture)> write_picture;  // a frame that is complete
    std::function<void(JobId)> remove_pictures;          // of a job that is forgotten
  };
  explicit CoreThread(Parts parts);
  ~CoreThread();  // Stop

  // Thread safe. Events are applied in order.
  void Post(Event event);
  // From now on no call waits: workers and watchers are told that the coordinator ends. Thread safe.
  void Close();
  // Applies what was posted, then ends the thread.
  void Stop();

 private:
  void Run();
  std::vector<Event> WaitForEvents(Instant patience);
  void Deliver(FarmOutput output);
  void Answer(FarmOutput output);
  bool Sync();
  void Compact();
  void Load(FrameId frame);
  void Abandon();
  void TellWatchers(Instant now);
  Instant Patience(Instant now) const;

  Parts parts_;
  PendingAnswers answers_;
  std::vector<FarmOutput> unsynced_;  // in order; their answers wait for the disk
  bool closing_ = false;              // of the core thread
  Instant watchers_due_{};
  Instant sync_due_{}, compact_due_{};

  std::mutex mutex_;
  std::condition_variable posted_;
  std::vector<Event> events_;  // guarded by mutex_
  bool stopping_ = false;      // guarded by mutex_
  std::thread thread_;         // last: runs as soon as everything else is there
};

}  // namespace tessera
