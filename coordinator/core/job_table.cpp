#include "coordinator/core/job_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/core/extension.h"
#include "coordinator/core/schedule/policy.h"

namespace tessera {

Error NoSuchJob(JobId id) {
  return BadInput(fmt::format("there is no job {}; \"tessera jobs\" lists all jobs", Number(id)));
}

uint64_t MemoryOf(const JobSpec& spec) {
  constexpr uint64_t kNodeBytes = 48;  // of a map, besides what it holds
  uint64_t bytes = sizeof spec + spec.name.size();
  for (const FrameRequest& frame : spec.frames) {
    bytes += sizeof frame + frame.scene_file.size() + frame.options.size();
    for (const Channel& channel : frame.spec.channels) bytes += sizeof channel + channel.name.size();
    for (const auto& [name, value] : frame.spec.attributes)
      bytes += kNodeBytes + 2 * sizeof(std::string) + name.size() + value.size();
  }
  return bytes;
}

Job& JobTable::Add(JobId id, std::shared_ptr<const JobSpec> spec) {
  Job& job = jobs_[id];
  job.id = id;
  job.results.samples_total = SamplesOf(*spec);
  job.priority = spec->priority;
  submissions_[spec->submission] = id;
  open_.insert(id);
  ReserveIds(id);
  job.spec_bytes = MemoryOf(*spec);
  spec_bytes_ += job.spec_bytes;
  job.submitted = job.spec = std::move(spec);
  return job;
}

Job& JobTable::Add(JobId id, std::shared_ptr<const JobOrder> order) {
  JobSpec spec;
  spec.submission = order->submission;
  spec.name = order->name;
  spec.priority = order->priority;
  spec.package = order->scene.package;
  Job& job = Add(id, std::make_shared<const JobSpec>(std::move(spec)));
  job.order = std::move(order);
  return job;
}

void JobTable::SetFrames(Job& job, std::shared_ptr<const JobSpec> spec) {
  job.order = nullptr;
  job.order_problem.clear();
  job.results.samples_total = SamplesOf(*spec);
  spec_bytes_ -= job.spec_bytes;
  job.spec_bytes = MemoryOf(*spec);
  spec_bytes_ += job.spec_bytes;
  job.submitted = job.spec = std::move(spec);
}

Job* JobTable::Find(JobId id) {
  const auto found = jobs_.find(id);
  return found == jobs_.end() ? nullptr : &found->second;
}

const Job* JobTable::Find(JobId id) const {
  const auto found = jobs_.find(id);
  return found == jobs_.end() ? nullptr : &found->second;
}

Result<Job*> JobTable::FindOpen(JobId id, const char* what) {
  Job* const job = Find(id);
  if (job == nullptr) return NoSuchJob(id);
  if (!HasEnded(job->state)) return job;
  return BadInput(
      fmt::format("job {} is {}; it can no longer be {}", Number(id), JobStateName(job->state), what));
}

const Job* JobTable::FindSubmission(uint64_t submission) const {
  const auto found = submissions_.find(submission);
  return found == submissions_.end() ? nullptr : &jobs_.at(found->second);
}

uint64_t JobTable::OpenSpecBytes() const {
  uint64_t bytes = 0;
  for (const JobId id : open_) bytes += jobs_.at(id).spec_bytes;
  return bytes;
}

Result<void> JobTable::CheckSpecBytes(uint64_t bytes) const {
  const uint64_t known_bytes = OpenSpecBytes();
  if (known_bytes + bytes <= kSpecBytesMax) return {};
  return Failed(
      fmt::format("the descriptions of the farm's open jobs take {} MB and would exceed the limit of {} MB "
                  "with this job; wait for a job to end or cancel one, or submit fewer frames",
                  known_bytes >> 20, kSpecBytesMax >> 20));
}

void JobTable::Remove(JobId id) {
  submissions_.erase(jobs_.at(id).spec->submission);
  spec_bytes_ -= jobs_.at(id).spec_bytes;
  open_.erase(id);
  jobs_.erase(id);
}

}  // namespace tessera
