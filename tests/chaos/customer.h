// Users who submit jobs to farms with faults, one after another, and check every picture.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "tests/chaos/farm_history.h"

namespace tessera {

// A job that is submitted repeatedly, with the pictures of undisturbed renders.
struct ChaosJob {
  std::string scene;
  std::vector<std::string> options;
  std::vector<std::string> pictures;  // bytes, by frame; none: the job kills its workers
};

// Renders the pictures of all jobs without faults. Writes their scenes to `folder`.
std::vector<ChaosJob> PrepareJobs(const std::string& folder, int samples_per_pixel);
// A job whose scene needs more memory than `bytes`. Writes it to `folder`.
ChaosJob PrepareDeadlyJob(const std::string& folder, uint64_t bytes);

class Customers {
 public:
  static constexpr size_t kCustomers = 2;

  Customers(std::string folder, const FarmHistory& history, std::vector<ChaosJob> jobs, ChaosJob deadly)
      : folder_(std::move(folder)), history_(history), jobs_(std::move(jobs)), deadly_(std::move(deadly)) {}

  // Submits, watches, fetches and compares until Close, and then completes the current job and fetches all
  // earlier ones again. Customers with different numbers start with different jobs.
  void Work(size_t customer);
  // Submits the deadly job when it is ordered, and checks that it fails because of that.
  void WorkOnDeadlyJobs();
  // Has the deadly job submitted to a farm. Returns false while an earlier one is open.
  bool OrderDeadlyJob(int farm);
  bool is_deadly_job_open() const;
  void Close();
  // Abandons the current job.
  void GiveUp();

  // A job with a picture, to be fetched by others.
  struct Placed {
    FarmHistory::Place place;
    std::string id;
    const ChaosJob* job = nullptr;
  };
  std::optional<Placed> LastFinished() const;
  int pictures() const { return pictures_; }
  int pictures_again() const { return pictures_again_; }
  int jobs_lost() const { return jobs_lost_; }
  int deadly_jobs_failed() const { return deadly_jobs_failed_; }
  std::vector<std::string> problems() const;

 private:
  enum class Answer {
    kDone,
    kChanged,       // the farms have changed meanwhile: the answer is of no use
    kFileLost,      // the job failed because a file of its scene was damaged
    kKillsWorkers,  // the job failed because it kills its workers
    kFailed,        // in a way that must not happen; reported
  };
  enum class Outcome {
    kDone,
    kLost,  // the farm does not have the job any more, or has lost its files
    kFailed,
  };
  bool Do(const ChaosJob& job, size_t customer, int farm);
  void FetchAgain(size_t customer);
  std::optional<Placed> Submit(const ChaosJob& job, int farm);
  // Watches the job until it ends, wherever its farm is. Sets `change` to that of the history in which it
  // ended. Returns kChanged if the job is lost.
  Answer Watch(const Placed& placed, uint64_t* change);
  Outcome Collect(const Placed& placed, size_t customer);
  bool Compare(const Placed& placed, size_t customer);
  // `change`: of the history, before the address was read.
  Answer Ask(std::vector<std::string> arguments, const std::string& address, uint64_t change,
             std::string* answer);
  std::optional<Answer> Understand(int code, const std::string& errors, uint64_t change) const;
  // Returns when no change is going on.
  uint64_t AwaitNoChange() const;
  void Report(const std::string& problem);

  const std::string folder_;
  const FarmHistory& history_;
  const std::vector<ChaosJob> jobs_;
  const ChaosJob deadly_;
  std::atomic<bool> closed_ = false, gave_up_ = false;
  std::atomic<int> pictures_ = 0, pictures_again_ = 0, jobs_lost_ = 0, deadly_jobs_failed_ = 0;
  mutable std::mutex mutex_;
  std::condition_variable ordered_;
  // Guarded by mutex_.
  std::optional<int> deadly_order_;  // a farm
  bool is_deadly_job_open_ = false;
  std::array<std::vector<Placed>, kCustomers> finished_;
  std::vector<std::string> problems_;
};

}  // namespace tessera
