// Checks of a coordinator on this machine: its data directory, and what it listens on.
#pragma once

#include <sys/types.h>

#include <stop_token>
#include <string>
#include <vector>

#include "client/doctor/finding.h"

namespace tessera {

// A coordinator that runs on this machine, as far as this user may look at it.
struct RunningCoordinator {
  pid_t pid = 0;
  std::string data_dir;  // empty if its command line does not name one
};

std::vector<RunningCoordinator> FindCoordinators();
bool IsRunning(const RunningCoordinator& coordinator);

// The folder of --data-dir: who may read it, its certificates, its disk.
Findings CheckDataDirectory(const std::string& folder);

// Each address that the process listens on: whether other machines reach it, and whether it is encrypted.
// If this user may use its local socket, also what the coordinator answers.
Findings CheckListening(const RunningCoordinator& coordinator, std::stop_token stop);

}  // namespace tessera
