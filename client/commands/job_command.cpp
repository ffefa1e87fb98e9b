#include "client/commands/job_command.h"

#include <fmt/format.h>

#include "client/commands/connection.h"
#include "client/commands/status_text.h"
#include "client/commands/times_text.h"

namespace tessera {

void AddJobFlags(CLI::App& app, JobOptions& options) {
  AddJobArgument(app, options.job);
  AddConnectionFlags(app, options.connection);
  AddJsonFlag(app, options.json);
}

Result<int> PrintJobCall(const Result<JobStatus>& status, bool json) {
  if (!status) return status.error();
  fmt::print("{}\n", json ? JobJson(*status) : JobText(*status));
  if (!json) fmt::print("{}", TimesTable(status->times));
  return 0;
}

Result<int> RunJobCall(const JobOptions& options, Cancellation& cancellation, const JobCall& call) {
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  return PrintJobCall(call(**client, options.job), options.json);
}

Command JobCommand(const std::string& name, const std::string& summary, const JobCall& call) {
  return MakeCommand<JobOptions>({
      .name = name,
      .summary = summary,
      .examples = {{"For job 12", fmt::format("tessera {} 12", name)}},
      .add_flags = AddJobFlags,
      .run = [call](const JobOptions& options,
                    Cancellation& cancellation) { return RunJobCall(options, cancellation, call); },
  });
}

}  // namespace tessera
