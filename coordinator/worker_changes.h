// The changes that callers make to workers, through gRPC (jobs_service.cpp) and the web interface
// (web_calls.cpp), as those to jobs (job_changes.h).
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/call_gate.h"
#include "coordinator/core/farm.h"
#include "proto/terms.h"

namespace tessera {

struct WorkerChangeKind {
  std::string_view call;  // of the protocol, whose rule decides who may make the change
  void (*make)(Farm& farm, WorkerId worker);
};

inline constexpr WorkerChangeKind kWorkerChanges[] = {
    {.call = "Jobs.DrainWorkers", .make = [](Farm& farm, WorkerId worker) { farm.Drain(worker); }},
    {.call = "Jobs.ReleaseWorkers", .make = [](Farm& farm, WorkerId worker) { farm.Release(worker); }},
};

// The change that a call makes; null if it makes none.
constexpr const WorkerChangeKind* FindWorkerChange(std::string_view call) {
  for (const WorkerChangeKind& change : kWorkerChanges) {
    if (change.call == call) return &change;
  }
  return nullptr;
}

static_assert(std::ranges::all_of(kCallRules,
                                  [](const CallRule& rule) {
                                    return (rule.permission == Permission::kControlWorkers) ==
                                           (FindWorkerChange(rule.method) != nullptr);
                                  }),
              "a call that controls workers has no row in kWorkerChanges, or another call has one");
static_assert(std::ranges::all_of(kWorkerChanges,
                                  [](const WorkerChangeKind& change) {
                                    const CallRule* const rule = FindRule(change.call);
                                    return rule != nullptr && rule->effect == Effect::kChanges;
                                  }),
              "a change of workers has no rule in access.h that enters it in the audit log");

// Gives the caller the new status of the workers. Runs on the core thread.
using AnswerWorkerChange = std::function<void(const std::vector<WorkerStatus>& changed)>;

// Changes the workers that have this name or number, and finishes the call, which is that of the change:
// NOT_FOUND if there are none.
void ChangeWorkers(const UnaryCall& call, const WorkerChangeKind& change, const std::string& which,
                   const AnswerWorkerChange& answer);

}  // namespace tessera
