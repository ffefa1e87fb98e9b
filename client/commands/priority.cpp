// tessera priority
#include "client/commands/commands.h"
#include "client/commands/job_command.h"
#include "client/commands/option_values.h"

namespace tessera {
namespace {

struct PriorityOptions : JobOptions {
  int priority = 0;
};

void AddPriorityFlags(CLI::App& app, PriorityOptions& options) {
  AddJobFlags(app, options);
  AddValue(app, "N", "", "New priority; jobs with a higher priority run first", options.priority,
           WholeNumber<int>(-kPriorityMax, kPriorityMax), Presence::kRequired);
}

Result<int> RunPriority(const PriorityOptions& options, Cancellation& cancellation) {
  return RunJobCall(options, cancellation, [&](CoordinatorClient& client, JobId job) {
    return client.SetPriority(job, options.priority);
  });
}

}  // namespace

Command PriorityCommand() {
  return MakeCommand<PriorityOptions>({
      .name = "priority",
      .summary = "Change a job's priority",
      .examples = {{"Run job 12 before others", "tessera priority 12 10"}},
      .add_flags = AddPriorityFlags,
      .run = RunPriority,
  });
}

}  // namespace tessera
