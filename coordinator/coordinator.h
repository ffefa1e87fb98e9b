// The coordinator as a whole: everything between its options and its end.
#pragma once

#include <stop_token>

#include "coordinator/options.h"
#include "renderer/util/result.h"

namespace tessera {

// Runs until `termination` is requested. An error if it cannot start.
Result<void> RunCoordinator(const CoordinatorOptions& options, std::stop_token termination);

}  // namespace tessera
