// The changes that callers make to jobs. gRPC (jobs_service.cpp) and the web interface (web_calls.cpp) make
// all of them through here, so both check, log and answer the same. What a new change is missing does not
// compile: its rule (access.h), its gRPC method or its route (web/api/routes.h).
#pragma once

#include <algorithm>
#include <functional>
#include <string_view>

#include "coordinator/call_gate.h"
#include "coordinator/core/farm.h"
#include "coordinator/task_pool.h"
#include "proto/blobs/blob_store.h"
#include "proto/terms.h"

namespace tessera {

struct JobChangeKind {
  std::string_view call;           // of the protocol, whose rule decides who may make the change
  std::string_view argument = "";  // the field of the request that has the new value; empty: none
  int64_t min = 0, max = 0;        // of the value
  // Whether more is rendered of a job that may have ended. Its files may have been evicted since.
  bool needs_files = false;
  Result<JobStatus> (*make)(Farm& farm, Instant now, JobId job, int64_t value);
};

inline constexpr JobChangeKind kJobChanges[] = {
    {.call = "Jobs.Pause",
     .make = [](Farm& farm, Instant now, JobId job, int64_t) { return farm.SetPaused(now, job, true); }},
    {.call = "Jobs.Resume",
     .make = [](Farm& farm, Instant now, JobId job, int64_t) { return farm.SetPaused(now, job, false); }},
    {.call = "Jobs.Cancel",
     .make = [](Farm& farm, Instant now, JobId job, int64_t) { return farm.Cancel(now, job); }},
    {.call = "Jobs.SetPriority",
     .argument = "priority",
     .min = -kPriorityMax,
     .max = kPriorityMax,
     .make = [](Farm& farm, Instant now, JobId job,
                int64_t value) { return farm.SetPriority(now, job, static_cast<int32_t>(value)); }},
    {.call = "Jobs.Extend",
     .argument = "samples_per_pixel",
     .min = 1,
     .max = kSamplesPerPixelMax,
     .needs_files = true,
     .make = [](Farm& farm, Instant now, JobId job,
                int64_t value) { return farm.Extend(now, job, static_cast<uint32_t>(value)); }},
};

// The change that a call makes; null if it makes none.
constexpr const JobChangeKind* FindJobChange(std::string_view call) {
  for (const JobChangeKind& change : kJobChanges) {
    if (change.call == call) return &change;
  }
  return nullptr;
}

static_assert(std::ranges::all_of(kCallRules,
                                  [](const CallRule& rule) {
                                    return (rule.permission == Permission::kControlJobs) ==
                                           (FindJobChange(rule.method) != nullptr);
                                  }),
              "a call that controls jobs has no row in kJobChanges, or another call has one");
static_assert(std::ranges::all_of(kJobChanges,
                                  [](const JobChangeKind& change) {
                                    const CallRule* const rule = FindRule(change.call);
                                    return rule != nullptr && rule->effect == Effect::kChanges;
                                  }),
              "a change of jobs has no rule in access.h that enters it in the audit log");

// Thread safe.
class JobChanges {
 public:
  // Gives the caller the new status of the job, or why the farm does not change it. Returns the status of the
  // call. Runs on the core thread.
  using Answer = std::function<grpc::Status(const Result<JobStatus>& changed)>;

  JobChanges(const BlobStore& blobs, FileThreads& files) : blobs_(blobs), files_(files) {}
  // Changes a job if the caller may, and finishes the call, which is that of the change.
  void Make(const UnaryCall& call, const JobChangeKind& change, JobId job, int64_t value,
            const Answer& answer) const;

 private:
  // Calls `then` if the files of the job are stored, or finishes the call with the reason why they are not.
  void CheckFiles(const UnaryCall& call, JobId job, const std::function<void()>& then) const;

  const BlobStore& blobs_;
  FileThreads& files_;
};

}  // namespace tessera
