// The commands of `tessera-coordinator` that do not run a farm: `init` and `token`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "coordinator/options.h"
#include "renderer/util/result.h"

namespace tessera {

// Runs the command that `arguments` begin with and returns its exit code. Returns nullopt if they begin with
// none.
std::optional<Result<int>> RunSetupCommand(const std::vector<std::string>& arguments);

// Asks the coordinator that listens on `addresses`, started by this user on this machine, for a token, and
// prints it as `token` does.
Result<void> PrintStartToken(const StartToken& wish, const std::vector<Address>& addresses);

}  // namespace tessera
