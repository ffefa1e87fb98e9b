// `tessera`: the command line of the farm.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <map>

#include "client/command_line.h"
#include "client/commands.h"
#include "renderer/util/ending_signals.h"
#include "renderer/util/processor.h"

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

// The first signal cancels; the second ends us at once, and the kernel our child processes with us.
void OnSignal(Cancellation& cancellation, int count) {
  if (count > 1) ::_exit(static_cast<int>(ErrorKind::kInterrupted));
  cancellation.Cancel({ErrorKind::kInterrupted, "interrupted"});
}

int Report(Error error) {
  std::ranges::replace(error.message, '\n', ' ');
  fmt::print(stderr, "tessera: {}\n", error.message);
  return static_cast<int>(error.kind);
}

int Run(const std::vector<std::string>& arguments, Cancellation& cancellation) {
  const auto parsed = ParseCommandLine(arguments);
  if (!parsed) return Report(parsed.error());
  if (!parsed->answer.empty()) {
    fmt::print("{}", parsed->answer);
    return 0;
  }
  const auto code = Commands().at(parsed->options.command)(parsed->options, cancellation);
  if (code) return *code;
  return Report(cancellation.cancelled() ? cancellation.error() : code.error());
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  tessera::RequireProcessor();
  ::signal(SIGPIPE, SIG_IGN);  // a reader that goes away is an error of write, not our end
  tessera::Cancellation cancellation;
  const tessera::EndingSignals signals(
      [&cancellation](int count) { tessera::OnSignal(cancellation, count); });
  try {
    return tessera::Run({argv + 1, argv + argc}, cancellation);
  } catch (const std::exception& e) {  // out of memory and the like
    return tessera::Report(tessera::Failed(e.what()));
  }
}
