// tessera workers
#include "client/commands/commands.h"
#include "client/commands/worker_command.h"

namespace tessera {

Command WorkersCommand() {
  return AllWorkersCommand("workers", "List the workers of a farm",
                           [](CoordinatorClient& client, const std::string&) { return client.Workers(); });
}

}  // namespace tessera
