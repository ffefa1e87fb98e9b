// The specifications and scene packages of open jobs, for threads that do not own the farm. Kept up to date
// by the core thread before it gives the answers that a change causes. Thread safe.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <shared_mutex>

#include "proto/terms.h"

namespace tessera {

// How long workers may fetch the files of a job that has ended: until then they learn that it has.
constexpr std::chrono::seconds kPackageGrace{60};

class OpenJobs {
 public:
  using Clock = std::chrono::steady_clock;

  void Set(JobId job, std::shared_ptr<const JobSpec> spec) {
    const std::unique_lock lock(mutex_);
    std::shared_ptr<const JobSpec>& known = jobs_[job];
    if (known == nullptr) ++packages_[spec->package].open_jobs;
    known = std::move(spec);
  }
  void Remove(JobId job, Clock::time_point now = Clock::now()) {
    const std::unique_lock lock(mutex_);
    const auto found = jobs_.find(job);
    if (found == jobs_.end()) return;
    Package& package = packages_.at(found->second->package);
    --package.open_jobs;
    package.closed = now;
    jobs_.erase(found);
    std::erase_if(packages_, [now](const auto& each) { return !each.second.IsOpen(now); });
  }
  // Null if there is no such job or it has ended.
  std::shared_ptr<const JobSpec> Find(JobId job) const {
    const std::shared_lock lock(mutex_);
    const auto found = jobs_.find(job);
    return found != jobs_.end() ? found->second : nullptr;
  }
  // Whether an open job, or one that ended a moment ago, is rendered from the scene package.
  bool HasPackage(const Digest& package, Clock::time_point now = Clock::now()) const {
    const std::shared_lock lock(mutex_);
    const auto found = packages_.find(package);
    return found != packages_.end() && found->second.IsOpen(now);
  }

 private:
  struct Package {
    size_t open_jobs = 0;
    Clock::time_point closed{};  // the last of them
    bool IsOpen(Clock::time_point now) const { return open_jobs > 0 || now - closed < kPackageGrace; }
  };

  mutable std::shared_mutex mutex_;
  std::map<JobId, std::shared_ptr<const JobSpec>> jobs_;  // guarded by mutex_
  std::map<Digest, Package> packages_;                    // guarded by mutex_
};

}  // namespace tessera
