// Commands that make one call about the workers of a farm and print the workers that the coordinator answers.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "client/commands/command.h"
#include "client/coordinator/coordinator_client.h"

namespace tessera {

// `which` is the name of one or more workers, or the id of one.
using WorkerCall = std::function<Result<std::vector<WorkerStatus>>(
    CoordinatorClient& client, const std::string& which, uint64_t& left_out)>;

// A command with the argument WORKER.
Command WorkerCommand(const std::string& name, const std::string& summary, const WorkerCall& call);

// A command about all workers, which calls with an empty `which`.
Command AllWorkersCommand(const std::string& name, const std::string& summary, const WorkerCall& call);

}  // namespace tessera
