// Who may make which call. Every call of proto/*.proto has one rule here; a handler cannot be written without
// it (see call_gate.h). There is no login yet: every peer that reaches a listening address may do everything.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "renderer/util/result.h"

namespace tessera {

// Who makes a call.
struct Principal {
  std::string name = "unauthenticated";
  std::string peer;  // the address of the connection, for logs
};

// What a call does to the farm. Roles are sets of these.
enum class Permission {
  kProbe,           // learn that a coordinator runs here, and its version
  kView,            // read the state of jobs, workers and pictures
  kSubmit,          // upload scene files and submit jobs
  kControlJobs,     // change jobs
  kControlWorkers,  // drain and release workers
  kWork,            // do the work of a worker
};

struct CallRule {
  std::string_view method;  // "SERVICE.METHOD", without the package
  Permission permission;
};

constexpr CallRule kCallRules[] = {
    {"Blobs.FindMissing", Permission::kSubmit},
    {"Blobs.Upload", Permission::kSubmit},
    {"Blobs.Download", Permission::kWork},
    {"Jobs.Submit", Permission::kSubmit},
    {"Jobs.List", Permission::kView},
    {"Jobs.Status", Permission::kView},
    {"Jobs.Watch", Permission::kView},
    {"Jobs.Cancel", Permission::kControlJobs},
    {"Jobs.Extend", Permission::kControlJobs},
    {"Jobs.Pause", Permission::kControlJobs},
    {"Jobs.Resume", Permission::kControlJobs},
    {"Jobs.SetPriority", Permission::kControlJobs},
    {"Jobs.Workers", Permission::kView},
    {"Jobs.Frames", Permission::kView},
    {"Jobs.DrainWorkers", Permission::kControlWorkers},
    {"Jobs.ReleaseWorkers", Permission::kControlWorkers},
    {"Jobs.FetchPicture", Permission::kView},
    {"Jobs.Health", Permission::kProbe},
    {"Work.Synchronize", Permission::kWork},
    {"Work.ReturnResults", Permission::kWork},
    {"Work.ReturnFailure", Permission::kWork},
};

// The rule of a call. Does not compile if there is none.
consteval const CallRule& RuleFor(std::string_view method) {
  for (const CallRule& rule : kCallRules) {
    if (rule.method == method) return rule;
  }
  throw "the call has no rule";
}

// Decides on a call; the error is the message to the caller. Called from any thread.
using AccessPolicy = std::function<Result<void>(const Principal& caller, const CallRule& rule)>;

Result<void> AdmitEveryone(const Principal& caller, const CallRule& rule);

}  // namespace tessera
