// tessera workers
#include "client/commands/commands.h"
#include "client/commands/worker_command.h"

namespace tessera {

Command WorkersCommand() {
  return AllWorkersCommand("workers", "List the workers of a farm",
                           [](CoordinatorClient& client, const std::string&, uint64_t& left_out) {
                             return client.Workers(left_out);
                           });
}

}  // namespace tessera
