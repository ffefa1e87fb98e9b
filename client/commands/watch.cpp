// tessera watch
#include "client/commands/commands.h"
#include "client/commands/connection.h"
#include "client/commands/job_command.h"
#include "client/commands/watching.h"

namespace tessera {
namespace {

Result<int> RunWatch(const JobOptions& options, Cancellation& cancellation) {
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  const auto status = WatchWithProgress(**client, options.job);
  if (!status) return status.error();
  PrintStatus(options, *status);
  if (status->state != JobState::kFinished) return EndedWithoutPicture(*status);
  return 0;
}

}  // namespace

Command WatchCommand() {
  return MakeCommand<JobOptions>({
      .name = "watch",
      .summary = "Follow a job's progress until it ends",
      .examples = {{"Follow job 12 until it ends", "tessera watch 12"}},
      .add_flags = AddJobFlags,
      .run = RunWatch,
  });
}

}  // namespace tessera
