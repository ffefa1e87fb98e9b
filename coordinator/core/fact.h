// Facts: what happened and must survive a crash. The state of a farm follows from its facts in order.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "coordinator/core/schedule/picture_file.h"
#include "proto/membership.h"
#include "proto/terms.h"
#include "renderer/util/result.h"

namespace tessera {

// A process opened the data directory. Its epoch is larger than all earlier ones. The farm is the same in all
// facts of a journal; earlier releases did not record it.
struct CoordinatorStarted {
  uint32_t epoch = 0;
  FarmId farm{};
};

struct JobSubmitted {
  JobId job{};
  std::shared_ptr<const JobSpec> spec;
};

// A job whose frames a worker is to make. JobSubmitted follows when one has.
struct JobOrdered {
  JobId job{};
  std::shared_ptr<const JobOrder> order;
};

// Who submits the job. Comes before JobSubmitted or JobOrdered, so that no crash leaves a job without its
// owner. Jobs of earlier releases have no such fact.
struct JobOwned {
  JobId job{};
  JobOwner owner;
};

// When the job was submitted and, if it has, ended, in milliseconds since 1970. What it waited between its
// end and an extension does not count: such a job began later. Jobs of earlier releases have no such fact.
// The last one holds; it may come before the fact of the job.
struct JobTimed {
  JobId job{};
  int64_t began_ms = 0;
  std::optional<int64_t> ended_ms;
  JobTimes times;  // of a job that has ended
};

// The file of the frame is written and synced; it replaces an earlier one.
struct FrameFinished {
  JobId job{};
  uint32_t frame = 0;
  PictureFile file;
  uint64_t samples = 0;  // pixel samples that it is made of
};

// No worker can render the frame. The other frames of the job are still rendered.
struct FrameFailed {
  JobId job{};
  uint32_t frame = 0;
  std::string reason;
};

struct JobEnded {
  JobId job{};
  JobState state{};
  std::string reason;
};

// Each frame of the job now has this many samples per pixel; finished frames are no longer finished.
struct JobExtended {
  JobId job{};
  uint32_t samples_per_pixel = 0;
};

// A frame that was finished before its job was extended has received more samples: the spool holds more than
// the sums with which it was finished.
struct FrameResumed {
  JobId job{};
  uint32_t frame = 0;
};

// Facts of ended jobs have been removed. Numbers up to this one are not used again.
struct JobsForgotten {
  JobId last{};
};

// The user paused the job: none of its units is leased until it is resumed.
struct JobPaused {
  JobId job{};
  bool paused = true;  // or resumed
};

struct JobPriorityChanged {
  JobId job{};
  int32_t priority = 0;
};

// The user has drained or the farm has quarantined a worker; with neither, it may work again.
struct WorkerQuarantined {
  WorkerId worker{};
  std::string name;
  bool drained = false;
  std::string quarantine;  // its reason, or empty
};

// A worker's vote on a unit that is verified: the digest of its result (RadianceTileDigest).
struct VoteRecorded {
  WorkUnit unit;
  WorkerId worker{};
  std::string name;  // the worker's
  Digest result;
  uint64_t machine = 0;  // that the worker ran on; 0: not known
};

// Counts of the verification so far.
struct UnitsCounted {
  JobId job{};
  uint64_t verified = 0, disputed = 0, suspect = 0;  // as in JobStatus
};

// An operator let somebody in, who has not joined yet. `revoked` is not part of this fact.
struct TokenIssued {
  TokenStatus token;
};

struct TokenRevoked {
  Digest key{};
};

// Uses the token once. `revoked` is not part of this fact.
struct MemberJoined {
  MemberStatus member;
};

// The member has a new certificate.
struct MemberRenewed {
  MemberId id{};
  UnixTime expires = 0;
};

struct MemberRevoked {
  MemberId id{};
};

// The authority that issues the certificates of members from now on.
struct AuthorityChosen {
  Digest fingerprint{};
};

using Fact = std::variant<CoordinatorStarted, JobSubmitted, FrameFinished, JobEnded, JobExtended,
                          JobsForgotten, FrameResumed, JobPaused, JobPriorityChanged, WorkerQuarantined,
                          VoteRecorded, UnitsCounted, TokenIssued, TokenRevoked, MemberJoined, MemberRenewed,
                          MemberRevoked, JobOwned, AuthorityChosen, JobOrdered, JobTimed, FrameFailed>;

// Whether files may be removed when the fact is on stable storage: the sums of a job that is not finished.
bool FreesSpace(const Fact& fact);

// A 32-bit number of the kind, then its members in order (byte_codec.h), texts and lists preceded by a 64-bit
// length. The meaning of a number never changes: a kind whose members change gets another number, and those
// it had before are still read. Kinds 1 (a start without the farm's identity), 2 (a submitted job whose
// channels are names), 20 (a vote without the worker's machine) and 22 (a finished frame without the size of
// its file) are no longer written.
std::string EncodeFact(const Fact& fact);
// An error for anything that EncodeFact does not write.
Result<Fact> DecodeFact(std::string_view bytes);

}  // namespace tessera
