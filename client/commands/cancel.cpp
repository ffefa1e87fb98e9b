// tessera cancel
#include "client/commands/commands.h"
#include "client/commands/job_command.h"

namespace tessera {

Command CancelCommand() {
  return JobCommand("cancel", "Cancel a job",
                    [](CoordinatorClient& client, JobId job) { return client.Cancel(job); });
}

}  // namespace tessera
