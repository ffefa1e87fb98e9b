// tessera release
#include "client/commands/commands.h"
#include "client/commands/worker_command.h"

namespace tessera {

Command ReleaseCommand() {
  return WorkerCommand("release", "Lease work to drained or quarantined workers again",
                       [](CoordinatorClient& client, const std::string& which, uint64_t& left_out) {
                         return client.Release(which, left_out);
                       });
}

}  // namespace tessera
