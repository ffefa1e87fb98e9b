// Who may make which call. Every call of proto/*.proto has one rule here; a handler cannot be written without
// it (see call_gate.h). There is no login yet: every peer that reaches a listening address may do everything.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "proto/terms.h"
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

// What a request may take, checked before it is parsed (message_guard.h).
struct MessageLimits {
  size_t bytes_max = 64 << 10;
  // Strings, messages, repeated and unknown numbers, each of which takes up to some 200 bytes of memory.
  size_t elements_max = 1000;
};
// Of the bytes of a chunk and what comes with them.
constexpr MessageLimits kChunkLimits{(kChunkBytesMax) + (64 << 10), 16};
// 10,000 frames, each with its channels and attributes.
constexpr MessageLimits kJobLimits{kMessageBytesMax, 1'000'000};
constexpr MessageLimits kDigestsLimits{kDigestsPerCallMax * 64, kDigestsPerCallMax};
// Each lease is a few messages of less than 128 bytes.
constexpr MessageLimits kStateLimits{kLeasesPerWorkerMax * 128, kLeasesPerWorkerMax * 8};
constexpr MessageLimits kResultsLimits{kMessageBytesMax, kResultsPerCallMax * 16};

struct CallRule {
  std::string_view method;  // "SERVICE.METHOD", without the package
  Permission permission;
  MessageLimits limits = {};
};

constexpr CallRule kCallRules[] = {
    {"Blobs.FindMissing", Permission::kSubmit, kDigestsLimits},
    {"Blobs.Upload", Permission::kSubmit, kChunkLimits},
    {"Blobs.Download", Permission::kWork},
    {"Jobs.Submit", Permission::kSubmit, kJobLimits},
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
    {"Work.Synchronize", Permission::kWork, kStateLimits},
    {"Work.ReturnResults", Permission::kWork, kResultsLimits},
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
