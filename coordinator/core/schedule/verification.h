// Which units of a frame are rendered by two workers, and what each of them returned. A result is accepted
// when two workers agree to the last bit; if two differ, the next vote decides. Pure bookkeeping: who holds
// which lease is in the lease table. Owned by the scheduler.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/schedule/frame_work.h"
#include "proto/terms.h"
#include "renderer/util/digest.h"

namespace tessera {

// What a worker returned for a unit.
struct Vote {
  WorkerId worker{};
  std::string name;  // the worker's, for people
  Digest result;
};

class Verification {
 public:
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
  void Hold(TileSamples unit, WorkerId worker);
  void Release(TileSamples unit, WorkerId worker);

  // Whether a vote of the worker is needed that no other worker is about to give.
  bool NeedsVoteOf(TileSamples unit, WorkerId worker) const;
  // Whether the worker may vote, needed or not: it neither has voted nor holds the unit.
  bool MayVote(TileSamples unit, WorkerId worker) const;
  // The first unit for which NeedsVoteOf holds, of tiles that `may` allows.
  std::optional<TileSamples> Find(WorkerId worker, const std::function<bool(uint32_t tile)>& may) const;
  // Units that need a vote which none of the workers may give.
  size_t CountStuck(const std::set<WorkerId>& workers) const;

  struct Quorum {
    bool is_new = false;           // false if the worker had voted already: then the rest is empty
    bool is_reached = false;       // this vote and another one agree: the verification has ended
    std::vector<Vote> dissenters;  // if reached: those that differ
    std::vector<Vote> votes;       // all of the unit
  };
  // The unit must be being verified.
  Quorum RecordVote(TileSamples unit, const Vote& vote);
  // The worker is not trusted any more: its votes are void. Returns the units that no other worker has
  // rendered or holds; they are not verified any more.
  std::vector<TileSamples> Distrust(WorkerId worker);

 private:
  struct Ballot {
    std::vector<Vote> votes;  // all different
    std::set<WorkerId> holders;
    bool Knows(WorkerId worker) const;
    bool IsWanting() const;
  };
  using Ballots = std::map<TileSamples, Ballot>;
  void Update(Ballots::const_iterator ballot);
  void Remove(TileSamples unit);

  double share_;
  uint64_t key_;
  Ballots units_;
  std::set<TileSamples> wanting_;  // need a vote that no worker is about to give
};

}  // namespace tessera
