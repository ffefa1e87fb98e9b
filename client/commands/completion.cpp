// tessera completion
#include "client/reference/completion_scripts.h"

#include <fmt/format.h>

#include "client/commands/command_line.h"
#include "client/commands/commands.h"
#include "proto/shell/flags.h"

namespace tessera {
namespace {

struct CompletionOptions {
  std::string shell;
};

void AddCompletionFlags(CLI::App& app, CompletionOptions& options) {
  AddText(app, "SHELL", "", "Shell to print it for: bash, zsh or fish", options.shell, Presence::kRequired);
}

Result<int> RunCompletion(const CompletionOptions& options, Cancellation&) {
  const auto script = CompletionScript(options.shell, ReferenceOf(AllCommands()));
  if (!script) return script.error();
  fmt::print("{}", *script);
  return 0;
}

}  // namespace

Command CompletionCommand() {
  return MakeCommand<CompletionOptions>({
      .name = "completion",
      .summary = "Print a script with which a shell completes commands and flags",
      .examples = {{"Complete in every new bash of this user",
                    "tessera completion bash >> ~/.bash_completion"},
                   {"Complete in fish", "tessera completion fish > ~/.config/fish/completions/tessera.fish"}},
      .add_flags = AddCompletionFlags,
      .run = RunCompletion,
  });
}

}  // namespace tessera
