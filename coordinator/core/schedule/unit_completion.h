// What follows when a unit is rendered: its lease ends, the farm learns what it cost and how fast its worker
// is, leases of the same samples are dropped, and a frame without open work is retired. Owned by the
// scheduler.
#pragma once

#include "coordinator/core/schedule/vote_counting.h"

namespace tessera {

class UnitCompletion {
 public:
  UnitCompletion(ScheduleState& state, LeaseControl& leases, FailureHandling& failures, VoteCounting& votes)
      : state_(state), leases_(leases), failures_(failures), votes_(votes) {}

  // A correct result of a known unit arrived: true if it is new. `render_seconds` is the worker's
  // measurement.
  bool Finish(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit, double render_seconds);
  // The worker's result of a known unit that needs votes. If it is accepted call Finish.
  VoteOutcome RecordVote(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit,
                         double render_seconds, const Digest& result);
  // Sets the samples of the tile that the merger needs. Does nothing if the frame is not active.
  void SetGoal(Job& job, uint32_t frame, uint32_t tile, const TileGoal& goal);
  // Marks samples as done that a former process accepted. Does nothing if the frame is not open.
  void RestoreDone(JobId job, uint32_t frame, TileSamples samples);

 private:
  void EndLease(Instant now, WorkerId worker, LeaseId lease, const WorkUnit& unit);
  void Credit(WorkerId worker, ActiveFrame& frame, const WorkUnit& unit, double render_seconds);
  void DropDoneLeases(const ActiveFrame& frame, const WorkUnit& unit);
  void Retire(Job& job, uint32_t frame);

  ScheduleState& state_;
  LeaseControl& leases_;
  FailureHandling& failures_;
  VoteCounting& votes_;
};

}  // namespace tessera
