// What breaks in a simulation, and when it heals. Faults are data: a list of kinds with an effect each, and a
// plan of times drawn from the seed. To add a fault: a row in kFaultKinds (faults.cpp) and its effect.
#pragma once

#include "tests/simulation/clients.h"
#include "tests/simulation/coordinator_process.h"
#include "tests/simulation/machines.h"
#include "tests/simulation/world.h"

namespace tessera {

class Faults {
 public:
  // What an effect may act on.
  struct Parts {
    World& world;
    CoordinatorProcess& coordinator;
    Machines& machines;
    Clients& clients;
  };
  explicit Faults(Parts parts) : parts_(parts) {}

  // Plans all faults of the options and the healing after them.
  void Start();

 private:
  void Heal();
  void FinishOtherDirectory();
  Parts parts_;
};

}  // namespace tessera
