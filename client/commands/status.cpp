// tessera status
#include "client/commands/commands.h"
#include "client/commands/job_command.h"

namespace tessera {

Command StatusCommand() {
  return JobCommand("status", "Show a job's progress",
                    [](CoordinatorClient& client, JobId job) { return client.Status(job); });
}

}  // namespace tessera
