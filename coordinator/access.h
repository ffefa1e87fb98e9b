// Who may make which call.
//
// How somebody gets in: an operator issues a join token (a random secret, of which the coordinator keeps the
// digest of a public key). Whoever holds it proves that in the TLS handshake, sends a signing request and
// gets a certificate of the farm's own authority, in which a URI names role and member (proto/identity).
// Nobody completes a handshake without a certificate of either kind (membership/peer_check.h). Programs of
// the coordinator's user on the same machine use a Unix socket, and may do everything.
//
// For each call, the gate (call_gate.h) finds out who calls: from the connection, and from the members that
// the farm knows now, so a revocation counts from the next call on. Then the table here decides: every call
// of proto/*.proto has one rule, and each role reaches some jobs with each permission. A handler cannot be
// written without a rule.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "proto/membership.h"
#include "proto/terms.h"
#include "renderer/util/result.h"

namespace tessera {

// Who makes a call.
struct Principal {
  std::optional<Role> role;  // none: the holder of a token
  MemberId member{};   // 0: the user of the coordinator, through a Unix socket, or the holder of a token
  Digest token_key{};  // of the holder of a token
  std::string name;
  std::string peer;  // the address of the connection, for logs

  std::string Text() const;  // "user \"ada\"" or "the holder of a token", for messages
  // As the owner of jobs.
  JobOwner Owner() const { return {member, name}; }
};

// What a call does to the farm.
enum class Permission {
  kProbe,           // learn that a coordinator runs here, and its version
  kView,            // read the state of jobs and workers
  kFetchPictures,   // read what jobs have rendered
  kSubmit,          // upload scene files and submit jobs
  kControlJobs,     // change jobs
  kControlWorkers,  // drain and release workers
  kWork,            // do the work of a worker
  kFetchFiles,      // read scene files
  kJoin,            // become a member
  kRenew,           // stay a member
  kAdminister,      // let others in, list and revoke them
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

// Whether a call is entered in the audit log.
enum class Effect {
  kReads,    // changes nothing
  kWorks,    // the work of a worker: too much for a log; results are facts, failures are logged by themselves
  kChanges,  // has one entry in the audit log, unless it is denied and logged as that
};

struct CallRule {
  std::string_view method;  // "SERVICE.METHOD", without the package
  Permission permission;
  Effect effect;
  MessageLimits limits = {};
  bool frees_space = false;  // so it is not refused because the disk is full
};

constexpr CallRule kCallRules[] = {
    {"Blobs.FindMissing", Permission::kSubmit, Effect::kReads, kDigestsLimits},
    {"Blobs.Upload", Permission::kSubmit, Effect::kChanges, kChunkLimits},
    {"Blobs.Download", Permission::kFetchFiles, Effect::kReads},
    {"Jobs.Submit", Permission::kSubmit, Effect::kChanges, kJobLimits},
    {"Jobs.List", Permission::kView, Effect::kReads},
    {"Jobs.Status", Permission::kView, Effect::kReads},
    {"Jobs.Watch", Permission::kView, Effect::kReads},
    {"Jobs.Cancel", Permission::kControlJobs, Effect::kChanges, {}, true},
    {"Jobs.Extend", Permission::kControlJobs, Effect::kChanges},
    {"Jobs.Pause", Permission::kControlJobs, Effect::kChanges},
    {"Jobs.Resume", Permission::kControlJobs, Effect::kChanges},
    {"Jobs.SetPriority", Permission::kControlJobs, Effect::kChanges},
    {"Jobs.Workers", Permission::kView, Effect::kReads},
    {"Jobs.Frames", Permission::kView, Effect::kReads},
    {"Jobs.DrainWorkers", Permission::kControlWorkers, Effect::kChanges},
    {"Jobs.ReleaseWorkers", Permission::kControlWorkers, Effect::kChanges},
    {"Jobs.FetchPicture", Permission::kFetchPictures, Effect::kReads},
    {"Jobs.JobLog", Permission::kView, Effect::kReads},
    {"Jobs.Health", Permission::kProbe, Effect::kReads},
    {"Work.Synchronize", Permission::kWork, Effect::kWorks, kStateLimits},
    {"Work.ReturnResults", Permission::kWork, Effect::kWorks, kResultsLimits},
    {"Work.ReturnFailure", Permission::kWork, Effect::kWorks},
    {"Work.ReturnPreparation", Permission::kWork, Effect::kWorks, kJobLimits},
    {"Access.Join", Permission::kJoin, Effect::kChanges},
    {"Access.Renew", Permission::kRenew, Effect::kChanges},
    {"Access.IssueToken", Permission::kAdminister, Effect::kChanges},
    {"Access.ListAccess", Permission::kAdminister, Effect::kReads},
    {"Access.Revoke", Permission::kAdminister, Effect::kChanges},
};

// The rule of a call; null if there is none.
constexpr const CallRule* FindRule(std::string_view method) {
  for (const CallRule& rule : kCallRules) {
    if (rule.method == method) return &rule;
  }
  return nullptr;
}

// The rule of a call. Does not compile if there is none.
consteval const CallRule& RuleFor(std::string_view method) {
  const CallRule* const rule = FindRule(method);
  return rule != nullptr ? *rule : throw "the call has no rule";
}

// On what a role may use a permission.
enum class Reach {
  kNothing,
  // Of a user: the jobs that it submitted. Of a worker: the processes that use its certificate, and the files
  // that are in scene packages of open jobs.
  kOwn,
  kEverything,
};

// Without a role, the holder of a token may join and do nothing else. Pictures are what a user's customers
// pay for, so users see the queue but not what others rendered.
constexpr Reach ReachOf(std::optional<Role> role, Permission permission) {
  const auto all_if = [](bool may) { return may ? Reach::kEverything : Reach::kNothing; };
  if (!role || permission == Permission::kJoin) return all_if(!role && permission == Permission::kJoin);
  if (permission == Permission::kProbe || permission == Permission::kRenew) return Reach::kEverything;
  switch (*role) {
    case Role::kWorker:
      return permission == Permission::kWork || permission == Permission::kFetchFiles ? Reach::kOwn
                                                                                      : Reach::kNothing;
    case Role::kViewer:
      return all_if(permission == Permission::kView || permission == Permission::kFetchPictures);
    case Role::kUser:
      if (permission == Permission::kControlJobs || permission == Permission::kFetchPictures)
        return Reach::kOwn;
      return all_if(permission == Permission::kView || permission == Permission::kSubmit);
    case Role::kOperator: return Reach::kEverything;
  }
  return Reach::kNothing;
}

// Decides on a call; the error is the message to the caller. Called from any thread.
using AccessPolicy = std::function<Result<void>(const Principal& caller, const CallRule& rule)>;

// The table above. The error says which roles may make the call.
Result<void> AdmitByRole(const Principal& caller, const CallRule& rule);
// Whether a caller whose role may make the call may make it for a job of this owner. A job without a member
// as its owner is that of nobody but operators. The error names the owner.
Result<void> AdmitByOwner(const Principal& caller, const CallRule& rule, JobId job, const JobOwner& owner);

}  // namespace tessera
