// tessera man
#include <fmt/format.h>

#include <algorithm>

#include "client/commands/command_line.h"
#include "client/commands/commands.h"
#include "client/reference/manual_page.h"
#include "proto/shell/flags.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

struct ManOptions {
  std::string command;  // empty: all of them
};

void AddManFlags(CLI::App& app, ManOptions& options) {
  AddText(app, "COMMAND", "", WithDefault("The command to describe", "the program"), options.command);
}

Result<int> RunMan(const ManOptions& options, Cancellation&) {
  const std::vector<CommandReference> commands = ReferenceOf(AllCommands());
  if (options.command.empty()) {
    fmt::print("{}", ManualPage(commands));
    return 0;
  }
  const auto command = std::ranges::find(commands, options.command, &CommandReference::name);
  if (command == commands.end()) {
    std::vector<std::string_view> names;
    names.reserve(commands.size());
    for (const CommandReference& each : commands) names.push_back(each.name);
    return BadInput(fmt::format("COMMAND: there is no command \"{}\"{}", options.command,
                                DidYouMean(options.command, names)));
  }
  fmt::print("{}", ManualPage(*command));
  return 0;
}

}  // namespace

Command ManCommand() {
  return MakeCommand<ManOptions>({
      .name = "man",
      .summary = "Print a manual page, in the form that man and groff read",
      .examples = {{"Read the page of a command", "tessera man render | man -l -"},
                   {"Install the page of the program", "tessera man > ~/.local/share/man/man1/tessera.1"}},
      .add_flags = AddManFlags,
      .run = RunMan,
  });
}

}  // namespace tessera
