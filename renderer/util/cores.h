// How many threads can run at the same time.
#pragma once

namespace tessera {

// The processors that this process may use, at least 1: those that a container, taskset or a batch
// system left it.
int UsableCores();

}  // namespace tessera
