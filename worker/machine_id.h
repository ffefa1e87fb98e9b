// Tells machines apart. Thread safe.
#pragma once

#include <cstdint>

namespace tessera {

// The same in all processes on this machine, including those in containers, until it is restarted; a hash, so
// it reveals nothing else. 0 if the system does not tell.
uint64_t MachineId();

}  // namespace tessera
