// tessera release
#include "client/commands/commands.h"
#include "client/commands/worker_command.h"

namespace tessera {

Command ReleaseCommand() {
  return WorkerCommand(
      "release", "Lease work to drained or quarantined workers again",
      [](CoordinatorClient& client, const std::string& which) { return client.Release(which); });
}

}  // namespace tessera
