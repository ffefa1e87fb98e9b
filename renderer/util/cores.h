// How many threads can run at once.
#pragma once

namespace tessera {

// The processors that this process may use, at least 1: what a container, taskset or a batch system left of
// the machine.
int UsableCores();

}  // namespace tessera
