// The specifications of open jobs, for threads that do not own the farm. Kept up to date by the core thread
// before it gives the answers that a change causes. Thread safe.
#pragma once

#include <map>
#include <memory>
#include <shared_mutex>

#include "proto/terms.h"

namespace tessera {

class OpenJobs {
 public:
  void Set(JobId job, std::shared_ptr<const JobSpec> spec) {
    const std::unique_lock lock(mutex_);
    jobs_[job] = std::move(spec);
  }
  void Remove(JobId job) {
    const std::unique_lock lock(mutex_);
    jobs_.erase(job);
  }
  // Null if there is no such job or it has ended.
  std::shared_ptr<const JobSpec> Find(JobId job) const {
    const std::shared_lock lock(mutex_);
    const auto found = jobs_.find(job);
    return found != jobs_.end() ? found->second : nullptr;
  }

 private:
  mutable std::shared_mutex mutex_;
  std::map<JobId, std::shared_ptr<const JobSpec>> jobs_;  // guarded by mutex_
};

}  // namespace tessera
