// tessera resume
#include "client/commands/commands.h"
#include "client/commands/job_command.h"

namespace tessera {

Command ResumeCommand() {
  return JobCommand("resume", "Resume a paused job",
                    [](CoordinatorClient& client, JobId job) { return client.Resume(job); });
}

}  // namespace tessera
