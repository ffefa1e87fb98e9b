// Which units of a frame are rendered by two workers, and what each of them returned. A result is accepted
// when two workers agree to the last bit; if two differ, the next vote decides. Workers on one machine may
// share its faults, so their votes confirm each other only if no other machine votes in time. Pure
// bookkeeping: who holds which lease is in the lease table. Owned by the scheduler.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/schedule/frame_work.h"
#include "coordinator/core/schedule/instant.h"
#include "proto/terms.h"
#include "renderer/util/digest.h"

namespace tessera {

// What a worker returned for a unit.
struct Vote {
  WorkerId worker{};
  std::string name;  // the worker's, for people
  Digest result;
  uint64_t machine = 0;  // that the worker runs on; 0: not known
};

// A worker that may vote. Machine 0 counts as different from every other.
struct Voter {
  WorkerId worker{};
  uint64_t machine = 0;
};

class Verification {
 public:
  struct Ballot {
    std::vector<Vote> votes;               // all different
    std::map<WorkerId, uint64_t> holders;  // and their machines
    std::optional<Instant> wanting_since;  // as noticed by Relax
    bool is_relaxed = false;               // any machine may vote
    bool is_disputed = false;
    bool Knows(WorkerId worker) const;
    // Whether a vote or a holder, `besides` not counted, is of the machine.
    bool IsOfMachine(uint64_t machine, std::optional<WorkerId> besides = std::nullopt) const;
    bool IsWanting() const;
  };

  // `share` of the units, 0 to 1, is chosen. Which ones follows from the unit and the key alone; without the
  // key they cannot be distinguished from others.
  Verification(double share, uint64_t key) : share_(share), key_(key) {}

  bool IsChosen(TileSamples unit) const;

  // ---- Units being verified: chosen ones from their first lease until workers agree ----
  void Begin(TileSamples unit);
  // Ends the verification if no worker has rendered the unit or holds it: its samples may be cut differently.
  // False if it goes on.
  bool Abandon(TileSamples unit);
  bool IsVerifying(TileSamples unit) const { return units_.contains(unit); }
  // Whether some of the samples belong to a unit being verified.
  bool Touches(TileSamples samples) const;
  std::vector<SampleRange> UnitsOf(uint32_t tile) const;
  // A worker holds a lease of the unit, or no longer does. Do nothing if the unit is not being verified.
  void Hold(TileSamples unit, Voter holder);
  void Release(TileSamples unit, WorkerId worker);

  // Whether a vote of the worker is needed that no other worker is about to give.
  bool NeedsVoteOf(TileSamples unit, Voter voter) const;
  // Whether the worker may vote, needed or not: it neither has voted nor holds the unit, and runs on another
  // machine than those who do, `besides` not counted, unless the unit has waited long enough for one (Relax).
  bool MayVote(TileSamples unit, Voter voter, std::optional<WorkerId> besides = std::nullopt) const;
  // The first unit for which NeedsVoteOf holds, of tiles that `may` allows.
  std::optional<TileSamples> Find(Voter voter, const std::function<bool(uint32_t tile)>& may) const;
  // Who could give a unit the vote that it needs.
  enum class Candidates { kNone, kSameMachine, kOtherMachine };
  using FindCandidates = std::function<Candidates(const Ballot& ballot, uint32_t tile)>;
  // Lets units that need a vote get it from any machine if there are candidates on the same machine only, or
  // if those on others have not taken the unit for kOtherMachinePatience. True if there are such units.
  bool Relax(Instant now, const FindCandidates& find);
  // Units that need a vote which none of the workers may give.
  size_t CountStuck(const std::set<WorkerId>& workers) const;

  struct Quorum {
    bool is_new = false;           // false if the vote does not count: then the rest is empty
    bool is_reached = false;       // this vote and another one agree: the verification has ended
    bool is_disputed = false;      // this is the first vote that differs from another
    std::vector<Vote> dissenters;  // if reached: those that differ
    std::vector<Vote> votes;       // all of the unit
  };
  // The unit must be being verified. A vote does not count if the worker has voted before, or if it agrees
  // with one from the same machine and the unit still waits for another machine; `is_one_machine`: there is
  // no other.
  Quorum RecordVote(TileSamples unit, const Vote& vote, bool is_one_machine);
  // The same for a vote that counted in a former process.
  void RestoreVote(TileSamples unit, const Vote& vote);
  void VisitVotes(const std::function<void(TileSamples unit, const Vote& vote)>& visit) const;
  // The worker is not trusted any more: its votes are void. Returns the units that no other worker has
  // rendered or holds; they are not verified any more.
  std::vector<TileSamples> Distrust(WorkerId worker);

 private:
  using Ballots = std::map<TileSamples, Ballot>;
  void Update(Ballots::const_iterator ballot);
  void Remove(TileSamples unit);

  double share_;
  uint64_t key_;
  Ballots units_;
  std::set<TileSamples> wanting_;  // need a vote that no worker is about to give
};

}  // namespace tessera
