// `tessera`: the command line of the farm.
#include <fmt/format.h>

#include <map>

#include "client/command_line.h"
#include "client/commands.h"
#include "proto/shell/program.h"

namespace tessera {
namespace {

const std::map<std::string, Command>& Commands() {
  static const std::map<std::string, Command> kCommands{
      {"render", RunRender},     {"submit", RunSubmit},   {"status", RunStatus},   {"watch", RunWatch},
      {"cancel", RunCancel},     {"fetch", RunFetch},     {"jobs", RunJobs},       {"workers", RunWorkers},
      {"info", RunInfo},         {"compare", RunCompare}, {"pause", RunPause},     {"resume", RunResume},
      {"priority", RunPriority}, {"drain", RunDrain},     {"release", RunRelease}, {"extend", RunExtend},
  };
  return kCommands;
}

Result<int> Run(const std::vector<std::string>& arguments, std::stop_token termination) {
  Cancellation cancellation;
  const std::stop_callback on_termination(termination, [&cancellation] {
    cancellation.Cancel({ErrorKind::kInterrupted, "interrupted"});
  });
  const auto parsed = ParseCommandLine(arguments);
  if (!parsed) return parsed.error();
  if (!parsed->answer.empty()) {
    fmt::print("{}", parsed->answer);
    return 0;
  }
  auto code = Commands().at(parsed->options.command)(parsed->options, cancellation);
  if (!code && cancellation.cancelled()) return cancellation.error();
  return code;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  return tessera::RunProgram("tessera", argc, argv, tessera::Run);
}
