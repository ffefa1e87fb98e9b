#include "client/commands/default_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "client/coordinator/farm_choice.h"
#include "proto/shell/console.h"

namespace tessera {
namespace {

constexpr size_t kJobsNamedMax = 8;  // in an error, which is one line

// "1 "box" (running), 2 "box" (paused) and 3 more"
std::string JobList(const std::vector<const JobStatus*>& jobs) {
  std::string list;
  for (size_t i = 0; i < std::min(jobs.size(), kJobsNamedMax); ++i) {
    list += fmt::format("{}{} \"{}\" ({})", i == 0 ? "" : ", ", Number(jobs[i]->job), jobs[i]->name,
                        JobStateName(jobs[i]->state));
  }
  if (jobs.size() > kJobsNamedMax) list += fmt::format(" and {} more", jobs.size() - kJobsNamedMax);
  return list;
}

}  // namespace

Result<JobId> DefaultJob(const std::vector<JobStatus>& jobs, MemberId owner) {
  const JobStatus* last = nullptr;
  std::vector<const JobStatus*> open;
  for (const JobStatus& job : jobs) {
    if (job.owner.member != owner) continue;
    last = &job;
    if (!HasEnded(job.state)) open.push_back(&job);
  }
  if (last == nullptr)
    return BadInput("JOB is required: no job of this farm is yours; tessera jobs lists those of others");
  if (open.size() > 1)
    return BadInput(fmt::format("JOB is required: {} of your jobs are open: {}", open.size(), JobList(open)));
  return open.empty() ? last->job : open.front()->job;
}

Result<JobId> ChooseJob(CoordinatorClient& client, const ConnectionOptions& connection,
                        const std::optional<JobId>& named) {
  if (named) return *named;
  const auto endpoint = ChooseFarm(connection.farm);
  if (!endpoint) return endpoint.error();
  const auto owner = MemberOf(*endpoint);
  if (!owner) return owner.error();
  uint64_t left_out = 0;
  const auto jobs = client.Jobs(left_out);
  if (!jobs) return jobs.error();
  const auto chosen = DefaultJob(*jobs, *owner);
  if (!chosen) return chosen;
  const auto job = std::ranges::find(*jobs, *chosen, &JobStatus::job);
  PrintNote("job {} \"{}\"\n", Number(*chosen), job->name);
  return chosen;
}

}  // namespace tessera
