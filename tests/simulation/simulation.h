// The real farm (scheduler, mergers, facts) and the real workload of each worker, with a modelled network,
// disk and clocks, all in simulated time and all from one seed. Faults for a while, then healing, then every
// job must have ended as it should. Its parts, one file each: coordinator process, machines, clients, faults,
// and the checkers that watch from outside (checker.h).
#pragma once

#include "tests/simulation/clients.h"
#include "tests/simulation/coordinator_process.h"
#include "tests/simulation/faults.h"
#include "tests/simulation/machines.h"
#include "tests/simulation/world.h"

namespace tessera {

class Simulation {
 public:
  using OnTrace = World::OnTrace;
  Simulation(uint64_t seed, SimulationOptions options, OnTrace on_trace = {})
      : world_(seed, std::move(options), std::move(on_trace)) {}
  SimulationReport Run();

 private:
  World world_;
  CoordinatorProcess coordinator_{world_};
  Machines machines_{world_, coordinator_};
  Clients clients_{world_, coordinator_};
  Faults faults_{{world_, coordinator_, machines_, clients_}};
};

}  // namespace tessera
