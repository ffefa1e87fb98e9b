// The tail of a job: nothing is open any more, some workers are idle, others are late. Units that wait at a
// slow worker are moved; those that run are split and rendered a second time (backup tasks: Dean and Ghemawat
// 2004, section 3.6). Owned by the scheduler.
#pragma once

#include <deque>
#include <optional>

#include "coordinator/core/schedule/lease_control.h"

namespace tessera {

class TailRelief {
 public:
  TailRelief(ScheduleState& state, LeaseControl& leases) : state_(state), leases_(leases) {}

  // Gives blocked workers units of slower ones. Looks only once per kTailInterval.
  void Relieve(Instant now);

 private:
  enum class Outcome {
    kGiven,
    kUnfit,   // the helper cannot render the unit
    kUseless  // neither the helper nor any slower one would end it sooner
  };
  int IdleSlots(const WorkerRecord& worker) const;
  std::deque<WorkerRecord*> Helpers() const;
  bool IsFit(Instant now, const WorkerRecord& helper, const LeaseRecord& slow) const;
  Outcome RelieveBy(Instant now, WorkerRecord& helper, LeaseId slow, int idle_slots);
  std::optional<SampleRange> PieceFor(const WorkUnit& unit, const ActiveFrame& frame, double whole_s,
                                      int idle_slots) const;

  ScheduleState& state_;
  LeaseControl& leases_;
  Instant due_{};
};

}  // namespace tessera
