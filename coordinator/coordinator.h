// The coordinator as a whole: everything between its options and its end.
#pragma once

#include "coordinator/options.h"
#include "renderer/util/result.h"

namespace tessera {

// Runs until SIGTERM or SIGINT, which the caller has blocked in all threads. An error if it cannot start.
Result<void> RunCoordinator(const CoordinatorOptions& options);

}  // namespace tessera
