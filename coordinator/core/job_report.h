// What people see of a job: its progress, why it does not move, and where its time went.
#pragma once

#include "coordinator/core/farm_state.h"

namespace tessera {

// When the job was submitted and ended, as a fact.
JobTimed TimedOf(const FarmState& state, const Job& job);
JobStatus StatusOf(const FarmState& state, Instant now, const Job& job);
// Keeps what StatusOf needs of open jobs: their recent rate and the moments of their clocks.
void MeasureProgress(FarmState& state, Instant now);
// Adds the time that was given up since the last call to the jobs it was spent on.
void CountGivenUp(FarmState& state);

}  // namespace tessera
