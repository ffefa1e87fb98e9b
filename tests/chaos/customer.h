// A user who submits jobs to a farm with faults, one after another, and checks every picture.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

namespace tessera {

// A job that is submitted repeatedly, with the pictures of undisturbed renders.
struct ChaosJob {
  std::string scene;
  std::vector<std::string> options;
  std::vector<std::string> pictures;  // bytes, by frame
};

// Renders the pictures of all jobs without faults. Writes their scenes to `folder`.
std::vector<ChaosJob> PrepareJobs(const std::string& folder, int samples_per_pixel);

class Customers {
 public:
  Customers(std::string folder, std::string address, std::vector<ChaosJob> jobs)
      : folder_(std::move(folder)), address_(std::move(address)), jobs_(std::move(jobs)) {}

  // Submits, watches, fetches and compares until Close, and then completes the current job. Customers with
  // different numbers start with different jobs.
  void Work(size_t customer);
  void Close() { closed_ = true; }
  // Abandons the current job.
  void GiveUp() { gave_up_ = true; }

  int pictures() const { return pictures_; }
  std::vector<std::string> problems() const;

 private:
  bool Do(const ChaosJob& job, size_t customer);
  // Returns false after a failure, which is reported. A failure because of a damaged scene file is reported
  // in `has_lost_files` instead, if that is given.
  bool Ask(std::vector<std::string> arguments, std::string* answer, bool* has_lost_files = nullptr);
  void Report(const std::string& problem);

  const std::string folder_, address_;
  const std::vector<ChaosJob> jobs_;
  std::atomic<bool> closed_ = false, gave_up_ = false;
  std::atomic<int> pictures_ = 0;
  mutable std::mutex mutex_;
  std::vector<std::string> problems_;
};

}  // namespace tessera
