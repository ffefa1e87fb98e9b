// Commands that make one call about a job and print the status that the coordinator answers.
#pragma once

#include <functional>
#include <string>

#include "client/commands/command.h"
#include "client/commands/option_groups.h"
#include "client/coordinator/coordinator_client.h"

namespace tessera {

struct JobOptions {
  JobId job{};
  ConnectionOptions connection;
  bool json = false;
};
void AddJobFlags(CLI::App& app, JobOptions& options);

using JobCall = std::function<Result<JobStatus>(CoordinatorClient& client, JobId job)>;
Result<int> RunJobCall(const JobOptions& options, Cancellation& cancellation, const JobCall& call);

// A command without further options.
Command JobCommand(const std::string& name, const std::string& summary, const JobCall& call);

// Prints the status that a call answered, as JSON or as text with a table of times. Returns the exit code.
Result<int> PrintJobCall(const Result<JobStatus>& status, bool json);

}  // namespace tessera
