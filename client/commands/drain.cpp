// tessera drain
#include "client/commands/commands.h"
#include "client/commands/worker_command.h"

namespace tessera {

Command DrainCommand() {
  return WorkerCommand("drain", "Stop leasing work to workers; they finish what they hold",
                       [](CoordinatorClient& client, const std::string& which, uint64_t& left_out) {
                         return client.Drain(which, left_out);
                       });
}

}  // namespace tessera
