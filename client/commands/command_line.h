// Reads the command line of `tessera`.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "client/commands/command.h"
#include "renderer/util/result.h"

namespace tessera {

struct CommandLine {
  // If not empty: the help or the version, to be printed instead of running a command.
  std::string answer;
  // Runs the command that was chosen.
  std::function<Result<int>(Cancellation& cancellation)> run;
};

// Parses `arguments`, without the program's name, as one of `commands` with its flags and checks its options.
// An unknown command or flag is bad input; the error suggests the nearest known one.
Result<CommandLine> ParseCommandLine(const std::vector<Command>& commands,
                                     const std::vector<std::string>& arguments);

// What the commands accept, in their order.
std::vector<CommandReference> ReferenceOf(const std::vector<Command>& commands);

}  // namespace tessera
