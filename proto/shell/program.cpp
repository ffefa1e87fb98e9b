#include "proto/shell/program.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "proto/shell/termination_signals.h"
#include "renderer/util/processor.h"

namespace tessera {

int Report(const std::string& name, const Error& error) {
  std::string message = error.message;
  std::ranges::replace(message, '\n', ' ');
  fmt::print(stderr, "{}: {}\n", name, message);
  return static_cast<int>(error.kind);
}

int RunProgram(const std::string& name, int argc, char** argv, const ProgramBody& body) {
  RequireProcessor();
  // A reader of our output that goes away is a write error and does not end the program.
  ::signal(SIGPIPE, SIG_IGN);
  std::stop_source termination;
  const TerminationSignals signals([&termination](int count) {
    if (count > 1) ::_exit(static_cast<int>(ErrorKind::kInterrupted));
    termination.request_stop();
  });
  try {
    const auto code = body({argv + 1, argv + argc}, termination.get_token());
    return code ? *code : Report(name, code.error());
  } catch (const std::exception& e) {
    return Report(name, Failed(e.what()));
  }
}

std::string Environment(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr ? value : "";
}

}  // namespace tessera
