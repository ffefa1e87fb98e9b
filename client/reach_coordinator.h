// The coordinator that a command speaks with.
#pragma once

#include <memory>

#include "client/cancellation.h"
#include "client/coordinator/coordinator_client.h"
#include "client/options.h"

namespace tessera {

// Waits for it as long as the user wants, and says so on the standard error if it does not answer at once.
Result<std::unique_ptr<CoordinatorClient>> ReachCoordinator(const Options& options,
                                                            Cancellation& cancellation);

}  // namespace tessera
