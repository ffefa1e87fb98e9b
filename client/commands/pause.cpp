// tessera pause
#include "client/commands/commands.h"
#include "client/commands/job_command.h"

namespace tessera {

Command PauseCommand() {
  return JobCommand("pause", "Pause a job",
                    [](CoordinatorClient& client, JobId job) { return client.Pause(job); });
}

}  // namespace tessera
