// All jobs that the farm knows: the one record of each, open or ended. Records stay where they are. Owned by
// the farm.
#pragma once

#include <map>
#include <memory>
#include <set>

#include "coordinator/core/schedule/job.h"
#include "renderer/util/result.h"

namespace tessera {

class JobTable {
 public:
  // A new open job.
  Job& Add(JobId id, std::shared_ptr<const JobSpec> spec);
  // The same for a job whose frames a worker is to make.
  Job& Add(JobId id, std::shared_ptr<const JobOrder> order);
  // A worker has made them.
  void SetFrames(Job& job, std::shared_ptr<const JobSpec> spec);
  JobId next_id() const { return JobId{next_}; }
  // No job gets an id up to this one again.
  void ReserveIds(JobId last) { next_ = std::max(next_, Number(last) + 1); }

  // Return nullptr if there is no such job.
  Job* Find(JobId id);
  const Job* Find(JobId id) const;
  Job& At(JobId id) { return jobs_.at(id); }
  const Job& At(JobId id) const { return jobs_.at(id); }
  // The error says that there is no such job, or that it has ended and cannot be `what` any more.
  Result<Job*> FindOpen(JobId id, const char* what);
  // The job that was submitted with this number; nullptr if there is none.
  const Job* FindSubmission(uint64_t submission) const;

  const std::map<JobId, Job>& all() const { return jobs_; }
  std::map<JobId, Job>& all() { return jobs_; }
  const std::set<JobId>& open() const { return open_; }
  // The caller sets the record's state.
  void MarkEnded(JobId id) { open_.erase(id); }
  void MarkOpen(JobId id) { open_.insert(id); }
  void Remove(JobId id);
  // Memory that the specifications of all jobs, and of those that are open, take.
  uint64_t spec_bytes() const { return spec_bytes_; }
  uint64_t OpenSpecBytes() const;
  // Whether another `bytes` of specifications of open jobs are within the limit.
  Result<void> CheckSpecBytes(uint64_t bytes) const;

 private:
  std::map<JobId, Job> jobs_;
  std::map<uint64_t, JobId> submissions_;
  std::set<JobId> open_;
  uint64_t next_ = 1;
  uint64_t spec_bytes_ = 0;
};

// Memory that a specification takes, roughly.
uint64_t MemoryOf(const JobSpec& spec);

Error NoSuchJob(JobId id);

}  // namespace tessera
