// `tessera`: the command line of the farm.
#include <fmt/format.h>

#include "client/commands/command_line.h"
#include "client/commands/commands.h"
#include "client/commands/settings.h"
#include "client/coordinator/coordinator_client.h"
#include "proto/shell/program.h"

namespace tessera {
namespace {

// Parses the arguments together with what the environment and the file of settings add to them.
Result<CommandLine> Parse(const std::vector<std::string>& arguments) {
  const std::string path = SettingsPath(Environment);
  const auto settings = ReadSettings(path);
  if (!settings) return settings.error();
  const auto words = WithSettings(arguments, ReferenceOf(AllCommands()), *settings, Environment);
  if (!words) return words.error();
  auto parsed = ParseCommandLine(AllCommands(), *words);
  if (parsed || *words == arguments || !ParseCommandLine(AllCommands(), arguments)) return parsed;
  return BadInput(fmt::format("{}; see $TESSERA_... variables and {}", parsed.error().message, path));
}

Result<int> Run(const std::vector<std::string>& arguments, std::stop_token termination) {
  Cancellation cancellation;
  const std::stop_callback on_termination(termination, [&cancellation] {
    cancellation.Cancel({ErrorKind::kInterrupted, "interrupted"});
  });
  const auto parsed = Parse(arguments);
  if (!parsed) return parsed.error();
  if (!parsed->answer.empty()) {
    fmt::print("{}", parsed->answer);
    return 0;
  }
  auto code = parsed->run(cancellation);
  // The first cause, such as the end of the local coordinator, explains more than the call that it broke.
  if (!code && cancellation.cancelled()) return cancellation.error();
  return code;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  tessera::CoordinatorClient::PrepareProcess();
  return tessera::RunProgram("tessera", argc, argv, tessera::Run);
}
