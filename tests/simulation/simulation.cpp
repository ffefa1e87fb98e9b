#include "tests/simulation/simulation.h"

namespace tessera {

SimulationReport Simulation::Run() {
  world_.Trace(world_.options.Text());
  coordinator_.Start();
  clients_.Start();
  machines_.Start();
  faults_.Start();
  const Instant limit = FromSeconds(world_.options.faults_s + world_.options.healed_limit_s);
  EventQueue& queue = world_.queue;
  while (!queue.empty() && queue.next_at() < limit && !(world_.is_healthy() && clients_.have_all_ended()))
    queue.RunNext();
  coordinator_.CheckEnd();
  return world_.TakeReport();
}

}  // namespace tessera
