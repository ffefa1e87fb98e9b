#include "client/commands/command_line.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>

#include "client/commands/pbrt_flags.h"
#include "proto/shell/flags.h"

namespace tessera {
namespace {

void AddCommand(const Command& command, CLI::App& app) {
  CLI::App& added = *app.add_subcommand(command.name, command.summary);
  command.add_flags(added);
  added.footer(ExamplesText(command.examples));
}

// `error`, with what to use instead if it is about an unknown flag that is pbrt's.
Error WithHint(Error error, const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    const std::string_view flag = std::string_view(argument).substr(0, argument.find('='));
    const auto hint = PbrtFlagHint(flag);
    if (hint && error.message.ends_with(fmt::format("unknown flag \"{}\"", flag)))
      error.message += fmt::format("; pbrt's {} {}", flag, *hint);
  }
  return error;
}

}  // namespace

Result<CommandLine> ParseCommandLine(const std::vector<Command>& commands,
                                     const std::vector<std::string>& arguments) {
  CLI::App app("Render scenes on this machine or on a farm of machines.", "tessera");
  app.footer("Run \"tessera COMMAND --help\" for the flags of a command.");
  app.require_subcommand(0, 1);  // a later word with the name of a command is an argument
  for (const Command& command : commands) AddCommand(command, app);
  const auto answer = ParseArguments(app, arguments);
  if (!answer) return WithHint(answer.error(), arguments);
  if (!answer->empty()) return CommandLine{*answer, nullptr};
  const auto chosen = app.get_subcommands();
  if (chosen.empty()) return BadInput("no command given; \"tessera --help\" lists the commands");
  const auto command = std::ranges::find(commands, chosen.front()->get_name(), &Command::name);
  if (auto checked = command->check(); !checked) return checked.error();
  return CommandLine{"", command->run};
}

std::vector<CommandReference> ReferenceOf(const std::vector<Command>& commands) {
  std::vector<CommandReference> reference;
  for (const Command& command : commands) {
    CLI::App app;
    AddCommand(command, app);
    reference.push_back(ReferenceOf(*app.get_subcommands(nullptr).front(), command.examples));
  }
  return reference;
}

}  // namespace tessera
