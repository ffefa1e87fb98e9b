// Somebody who hands jobs to a farm that is being hurt, one after the other, and looks at every picture.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

namespace tessera {

// A job that is done again and again, with the undisturbed pictures.
struct ChaosJob {
  std::string scene;
  std::vector<std::string> options;
  std::vector<std::string> pictures;  // bytes, by frame
};

// Renders the undisturbed pictures of the jobs that are used. `folder` gets the scenes.
std::vector<ChaosJob> PrepareJobs(const std::string& folder, int samples_per_pixel);

class Customers {
 public:
  Customers(std::string folder, std::string address, std::vector<ChaosJob> jobs)
      : folder_(std::move(folder)), address_(std::move(address)), jobs_(std::move(jobs)) {}

  // Hands in, watches, fetches and compares until Close; the job that is open then is brought to its end.
  // Number `customer` begins with another job than the others.
  void Work(size_t customer);
  void Close() { closed_ = true; }
  // The job that is open is left alone.
  void GiveUp() { gave_up_ = true; }

  int pictures() const { return pictures_; }
  std::vector<std::string> problems() const;

 private:
  bool Do(const ChaosJob& job, size_t customer);
  bool Ask(std::vector<std::string> arguments, std::string* answer);
  void Complain(const std::string& problem);

  const std::string folder_, address_;
  const std::vector<ChaosJob> jobs_;
  std::atomic<bool> closed_ = false, gave_up_ = false;
  std::atomic<int> pictures_ = 0;
  mutable std::mutex mutex_;
  std::vector<std::string> problems_;
};

}  // namespace tessera
