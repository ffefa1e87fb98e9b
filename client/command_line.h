// Reads the command line of `tessera`.
#pragma once

#include <string>
#include <vector>

#include "client/options.h"
#include "renderer/util/result.h"

namespace tessera {

struct CommandLine {
  Options options;
  std::string answer;  // not empty: print this (help, version) and be done
};

// `arguments` without the program's name. An unknown command or flag is bad input that suggests the nearest
// known one.
Result<CommandLine> ParseCommandLine(const std::vector<std::string>& arguments);

}  // namespace tessera
