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

void PrintStatus(const JobOptions& options, const JobStatus& status) {
  fmt::print("{}\n", options.json ? JobJson(status) : JobText(status));
}

Result<int> RunJobCall(const JobOptions& options, Cancellation& cancellation, const JobCall& call) {
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  const auto status = call(**client, options.job);
  if (!status) return status.error();
  PrintStatus(options, *status);
  if (!options.json) fmt::print("{}", TimesTable(status->times));
  return 0;
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
