// What may go wrong in a simulation, and how much.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tessera {

// A fault that happens at a moment; `kind` is its row in the table of faults.cpp.
struct PlannedFault {
  double at_s = 0;
  size_t kind = 0;
};
// The faults of a seed, by time.
std::vector<PlannedFault> DrawFaults(uint64_t seed, double until_s);
// The kind of this name, for simulations of chosen faults.
size_t FaultKindOf(const char* name);
// How many there are of each kind.
std::string FaultsText(const std::vector<PlannedFault>& plan);

struct SimulationOptions {
  int workers = 2;
  int jobs = 1;
  // ---- The network, each way: shares of messages
  double loss = 0;
  double duplication = 0;
  double reordering = 0;  // of messages that arrive much later than those sent after them
  double delay_max_s = 0.001;
  // ---- Machines
  double slow_share = 0;  // of the workers: ten times slower
  std::vector<PlannedFault> faults;
  double faults_s = 40;  // then all that is broken heals
  // Data directories that have the address in turn: 2 if there are faults that swap them.
  size_t directories() const;
  // ---- Work
  double noise_threshold = 0;  // of half the frames, which are adaptive then; 0: of none
  bool one_fails_units = false;
  bool one_damages_results = false;
  bool poison = false;  // one job has a unit that every worker fails
  bool killer = false;  // one job has a unit that kills every worker that renders it
  bool cancel_one = false;
  double ordered_share = 0;         // of the jobs: workers make their frames
  bool one_never_prepares = false;  // what a worker prepares never ends
  double healed_limit_s = 400;      // in which a healed farm must end every job
  double verify_share = 0;          // of every job
  bool one_lies = false;     // a worker returns wrong sums of the right form; all units are verified then
  bool ill_machine = false;  // the first two workers return the same wrong sums

  std::string Text() const;
};

// The mix of a seed.
SimulationOptions DrawOptions(uint64_t seed);

}  // namespace tessera
