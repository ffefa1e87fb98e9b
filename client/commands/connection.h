// The connection of a command to its coordinator.
#pragma once

#include <memory>

#include "client/cancellation.h"
#include "client/commands/option_groups.h"
#include "client/coordinator/coordinator_client.h"

namespace tessera {

// Waits for the coordinator as long as the options allow, and prints so on stderr if it takes more than a
// moment.
Result<std::unique_ptr<CoordinatorClient>> Connect(const ConnectionOptions& options,
                                                   Cancellation& cancellation);

}  // namespace tessera
