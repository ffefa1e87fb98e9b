// Makes the state that a worker sends and the farm's own agree: renews the leases it lists, takes over
// unknown ones, ends those of workers that are gone, and collects what the worker is to be told. Owned by the
// scheduler.
#pragma once

#include "coordinator/core/schedule/dispatcher.h"
#include "coordinator/core/schedule/suspect_trials.h"
#include "coordinator/core/schedule/vote_counting.h"

namespace tessera {

// The part of a directive that answers to results carry, of bounded size.
struct LeaseGrants {
  std::vector<Lease> leases;
  std::vector<LeaseId> drop;
};

// How a worker went.
enum class Departure {
  kGoodbye,
  kCut,    // its connection broke
  kSilent  // it has not called for long
};

class WorkerSync {
 public:
  WorkerSync(ScheduleState& state, LeaseControl& leases, SceneLocality& scenes, Dispatcher& dispatcher,
             SuspectTrials& trials, VoteCounting& votes)
      : state_(state),
        leases_(leases),
        scenes_(scenes),
        dispatcher_(dispatcher),
        trials_(trials),
        votes_(votes) {}

  // Does nothing if a later state of the worker has already arrived.
  void Synchronize(Instant now, const WorkerState& state);
  // The leases of the worker return. Does nothing if it is not connected.
  void Disconnect(Instant now, WorkerId worker, Departure how);
  // Ends what has expired: leases, silent workers, the memory of workers that are gone.
  void Expire(Instant now);

  LeaseGrants TakeGrants(Instant now, WorkerId worker);
  WorkerDirective TakeDirective(Instant now, WorkerId worker);

 private:
  void UpdateScenes(Instant now, WorkerRecord& worker, const WorkerState& state);
  void ReconcileLeases(Instant now, WorkerRecord& worker, const WorkerState& state);
  void AnnounceAgain(Instant now, WorkerRecord& worker);
  bool TakeOver(Instant now, WorkerRecord& worker, const HeldLease& held);

  ScheduleState& state_;
  LeaseControl& leases_;
  SceneLocality& scenes_;
  Dispatcher& dispatcher_;
  SuspectTrials& trials_;
  VoteCounting& votes_;
};

}  // namespace tessera
