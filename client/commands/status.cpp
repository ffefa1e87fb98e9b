// tessera status
#include "client/commands/commands.h"
#include "client/commands/connection.h"
#include "client/commands/default_job.h"
#include "client/commands/job_command.h"

namespace tessera {
namespace {

struct StatusOptions {
  std::optional<JobId> job;  // nullopt: the default job
  ConnectionOptions connection;
  bool json = false;
};

void AddStatusFlags(CLI::App& app, StatusOptions& options) {
  AddDefaultJobArgument(app, options.job);
  AddConnectionFlags(app, options.connection);
  AddJsonFlag(app, options.json);
}

Result<int> RunStatus(const StatusOptions& options, Cancellation& cancellation) {
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  const auto job = ChooseJob(**client, options.connection, options.job);
  if (!job) return job.error();
  return PrintJobCall((*client)->Status(*job), options.json);
}

}  // namespace

Command StatusCommand() {
  return MakeCommand<StatusOptions>({
      .name = "status",
      .summary = "Show a job's progress",
      .examples = {{"Of your job", "tessera status"}, {"Of job 12", "tessera status 12"}},
      .add_flags = AddStatusFlags,
      .run = RunStatus,
  });
}

}  // namespace tessera
