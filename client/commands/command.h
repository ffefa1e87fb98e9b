// What a command of `tessera` is made of. Each command is a file of this folder that defines its options, the
// flags that fill them, a check of them as a whole, and what it does. commands.h lists all commands.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "client/cancellation.h"
#include "client/reference/reference.h"
#include "renderer/util/result.h"

namespace CLI {
class App;
}

namespace tessera {

// A command as the program sees it. One command line is parsed with it.
struct Command {
  std::string name;
  std::string summary;  // imperative: "Pause a job"
  std::vector<Example> examples;
  // Adds the flags and arguments (proto/shell/flags.h).
  std::function<void(CLI::App& app)> add_flags;
  // Fails if the options that were parsed do not make sense together.
  std::function<Result<void>()> check;
  // Prints the answer on stdout and everything else on stderr. Returns the exit code; an error is printed by
  // the caller.
  std::function<Result<int>(Cancellation& cancellation)> run;
};

// The same in terms of the command's own options, which do not change after they have been parsed.
template <typename Options>
struct CommandParts {
  std::string name;
  std::string summary;
  std::vector<Example> examples = {};  // at least one
  std::function<void(CLI::App& app, Options& options)> add_flags;
  std::function<Result<void>(const Options& options)> check = nullptr;
  std::function<Result<int>(const Options& options, Cancellation& cancellation)> run;
};

template <typename Options>
Command MakeCommand(CommandParts<Options> parts) {
  // Shared by the three functions of the command.
  const auto options = std::make_shared<Options>();
  return {
      parts.name,
      parts.summary,
      parts.examples,
      [options, add_flags = parts.add_flags](CLI::App& app) { add_flags(app, *options); },
      [options, check = parts.check] { return check ? check(*options) : Result<void>(); },
      [options, run = parts.run](Cancellation& cancellation) { return run(*options, cancellation); },
  };
}

}  // namespace tessera
