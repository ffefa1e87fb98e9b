// tessera jobs
#include <fmt/format.h>

#include "client/commands/commands.h"
#include "client/commands/connection.h"
#include "client/commands/status_text.h"
#include "proto/shell/console.h"

namespace tessera {
namespace {

struct JobsOptions {
  ConnectionOptions connection;
  bool json = false;
};

void AddJobsFlags(CLI::App& app, JobsOptions& options) {
  AddConnectionFlags(app, options.connection);
  AddJsonFlag(app, options.json);
}

Result<int> RunJobs(const JobsOptions& options, Cancellation& cancellation) {
  const auto client = Connect(options.connection, cancellation);
  if (!client) return client.error();
  uint64_t left_out = 0;
  const auto jobs = (*client)->Jobs(left_out);
  if (!jobs) return jobs.error();
  if (left_out > 0) PrintNote("tessera: {} older jobs are not listed\n", left_out);
  fmt::print("{}", options.json ? JobsJson(*jobs) + "\n" : JobTable(*jobs));
  return 0;
}

}  // namespace

Command JobsCommand() {
  return MakeCommand<JobsOptions>({
      .name = "jobs",
      .summary = "List the jobs of a farm",
      .examples = {{"List the jobs of the farm", "tessera jobs"},
                   {"List them for a script", "tessera jobs --json"}},
      .add_flags = AddJobsFlags,
      .run = RunJobs,
  });
}

}  // namespace tessera
