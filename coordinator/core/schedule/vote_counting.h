// Units that two workers render: records what each returned, accepts results that agree, and puts a worker
// that is alone with its result into quarantine. Owned by the scheduler.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/core/schedule/failure_handling.h"
#include "coordinator/core/schedule/lease_control.h"

namespace tessera {

struct VoteOutcome {
  enum class Kind {
    kHeld,      // another worker must return the same
    kAccepted,  // two workers agree: the result is to be merged
    kUseless    // the vote does not count, or the unit is not open as a whole any more
  };
  Kind kind = Kind::kUseless;
  std::optional<Vote> vote;  // to be kept
  bool is_disputed = false;  // it is the first that differs from another on its unit
};

class VoteCounting {
 public:
  VoteCounting(ScheduleState& state, LeaseControl& leases, FailureHandling& failures, int attempts_max)
      : state_(state), leases_(leases), failures_(failures), attempts_max_(attempts_max) {}

  // Whether a result of a known unit is not accepted from one worker alone.
  bool NeedsVote(const WorkUnit& unit);
  // A worker returned a result of a known unit. If no two of attempts_max workers agree the job fails.
  VoteOutcome RecordVote(const WorkUnit& unit, const Vote& vote);
  // A vote that was recorded by a former process.
  void RestoreVote(const WorkUnit& unit, const Vote& vote);
  // Units that wait for a vote from another machine may get it from any, if that is due.
  void Relax(Instant now);
  // Begins the verification of a unit that is chosen and open as a whole. Whether the unit is being verified.
  bool JoinVerification(ActiveFrame& frame, TileSamples samples);
  // Workers that were alone with a result, since the last call.
  std::vector<WorkerId> TakeDistrusted() { return std::exchange(distrusted_, {}); }

 private:
  using WorkersByMachine = std::map<uint64_t, std::vector<WorkerId>>;

  Verification::Candidates CandidatesFor(const Verification::Ballot& ballot, const FailureBook& failures,
                                         uint32_t tile, const WorkersByMachine& able) const;
  void Distrust(WorkerId worker, const std::string& reason);

  ScheduleState& state_;
  LeaseControl& leases_;
  FailureHandling& failures_;
  int attempts_max_;
  std::vector<WorkerId> distrusted_;
};

}  // namespace tessera
