// What may go wrong in a simulation, and how much.
#pragma once

#include <cstdint>
#include <string>

namespace tessera {

// Intervals are averages between two events of the kind, in seconds; 0: never.
struct SimulationOptions {
  int workers = 2;
  int jobs = 1;
  // ---- The network, each way
  double loss = 0;         // of a message
  double duplication = 0;  // of a message
  double reordering = 0;   // of a message: it comes much later than those sent after it
  double delay_max_s = 0.001;
  double partition_interval_s = 0;  // between the coordinator and one worker, one way or both
  // ---- Processes
  double slow_share = 0;           // of the workers: ten times slower
  double death_interval_s = 0;     // of some worker
  double drain_interval_s = 0;     // of some worker
  double hang_interval_s = 0;      // of some worker
  double crash_interval_s = 0;     // of the coordinator, also in the midst of a write
  double blackout_interval_s = 0;  // everything dies and starts again
  // ---- Machines
  double full_disk_interval_s = 0;   // the coordinator's
  double clock_jump_interval_s = 0;  // forwards, of any machine: it was asleep
  // ---- Work
  double noise_threshold = 0;  // of half the frames, which are adaptive then; 0: of none
  bool one_fails_units = false;
  bool one_damages_results = false;
  bool poison = false;  // one job has a unit that everybody fails
  bool cancel_one = false;
  double verify_share = 0;      // of every job
  bool one_lies = false;        // a worker returns wrong sums of the right form; all units are verified then
  double pause_interval_s = 0;  // of some job, or its going on
  double priority_interval_s = 0;  // another one for some job
  double faults_s = 40;            // then all that is broken heals

  std::string Text() const;
};

// The mix of a seed.
SimulationOptions DrawOptions(uint64_t seed);

}  // namespace tessera
