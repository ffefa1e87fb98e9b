// Which units of a frame are rendered by two workers, and what they say. Workers that agree to the last bit
// are believed; if two differ, the next opinion decides. Pure bookkeeping: who holds what is the lease
// table's. Owned by the scheduler.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/frame_work.h"
#include "proto/terms.h"
#include "renderer/util/digest.h"

namespace tessera {

// What a worker says that a unit is.
struct Opinion {
  WorkerId worker{};
  std::string name;  // the worker's, for people
  Digest result;
};

class Verification {
 public:
  // `share` of the units, 0 to 1. Which ones follows from the unit and the key alone; who does not know the
  // key cannot tell them from others.
  Verification(double share, uint64_t key) : share_(share), key_(key) {}

  bool IsChosen(TileSamples unit) const;

  // ---- Trials: chosen units from their first lease until workers agree ----
  void Begin(TileSamples unit);
  // Ends the trial if nobody has rendered the unit and nobody holds it: its samples may be cut anew.
  bool Abandon(TileSamples unit);
  bool IsOnTrial(TileSamples unit) const { return trials_.contains(unit); }
  // Whether some of the samples are of a unit on trial.
  bool Touches(TileSamples samples) const;
  std::vector<SampleRange> TrialsOf(uint32_t tile) const;
  // A worker holds a lease of the unit, or does so no longer. Nothing if it is not on trial.
  void Hold(TileSamples unit, WorkerId worker);
  void Release(TileSamples unit, WorkerId worker);

  // Whether the worker can give an opinion that is needed and that nobody else is about to give.
  bool Wants(TileSamples unit, WorkerId worker) const;
  // Whether the worker could give another opinion, needed or not.
  bool Admits(TileSamples unit, WorkerId worker) const;
  // The first unit for which Wants holds, of tiles that `may` allows.
  std::optional<TileSamples> Find(WorkerId worker, const std::function<bool(uint32_t tile)>& may) const;
  // Trials that need an opinion which none of the workers can give.
  size_t CountStuck(const std::set<WorkerId>& workers) const;

  struct Judgement {
    bool is_new = false;              // or the worker had spoken already: then the rest is empty
    bool decided = false;             // two agree, and this one is of them: the trial has ended
    std::vector<Opinion> dissenters;  // if decided: those that are alone
    std::vector<Opinion> opinions;    // all of the unit
  };
  // What a worker says of a unit on trial.
  Judgement Hear(TileSamples unit, const Opinion& opinion);
  // The worker is not believed any more: its opinions are void. Units that nobody else has rendered or holds
  // are not on trial any more: they are given back.
  std::vector<TileSamples> Disbelieve(WorkerId worker);
  // The samples are there in another way.
  void Drop(TileSamples unit);

 private:
  struct Trial {
    std::vector<Opinion> opinions;  // all different
    std::set<WorkerId> holders;
    bool Knows(WorkerId worker) const;
    bool IsWanting() const;
  };
  using Trials = std::map<TileSamples, Trial>;
  void Update(Trials::const_iterator trial);

  double share_;
  uint64_t key_;
  Trials trials_;
  std::set<TileSamples> wanting_;  // need an opinion that nobody is about to give
};

}  // namespace tessera
