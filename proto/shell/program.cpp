#include "proto/shell/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <system_error>

#include "proto/shell/console.h"
#include "proto/shell/secret_words.h"
#include "proto/shell/termination_signals.h"
#include "renderer/text/unicode.h"
#include "renderer/util/cores.h"
#include "renderer/util/processor.h"
#include "renderer/util/threads.h"

namespace tessera {
namespace {

// Besides two for each core: the threads of gRPC, of the status page and of a command. gRPC never ends if it
// could not start one.
constexpr int kThreadsMin = 28;

// What is printed of an error: two of the longest paths and their reasons.
constexpr size_t kErrorBytesMax = 16 << 10;

// Whether the system grants what libraries take for granted.
Result<void> CheckSystemLimits() {
  rlimit descriptors{};
  if (::getrlimit(RLIMIT_NOFILE, &descriptors) == 0 && descriptors.rlim_cur < kDescriptorsMin) {
    return Failed(fmt::format("at most {} files can be open at a time; at least {} are needed (ulimit -n)",
                              descriptors.rlim_cur, kDescriptorsMin));
  }
  return CheckThreads(kThreadsMin + 2 * UsableCores());
}

// Takes the numbers of standard streams that the caller has closed: a file that is opened later would get
// what is printed. Writing to them fails, as it would without.
void OccupyStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    const int flags = stream == STDIN_FILENO ? O_WRONLY : O_RDONLY;
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF) ::open("/dev/null", flags);
  }
}

// `reason`: a number of errno, or 0.
Error CannotPrint(int reason) {
  return Failed(fmt::format("the standard output: cannot be written{}{}", reason != 0 ? ": " : "",
                            reason != 0 ? std::strerror(reason) : ""));
}

// Writes what is still buffered of the standard output. A reader that went away has what it wanted.
Result<void> FinishOutput() {
  errno = 0;
  const bool is_written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (is_written || errno == EPIPE) return {};
  return CannotPrint(errno);
}

}  // namespace

void ReportUncaughtExceptions(const std::string& name) {
  static std::string program;
  program = name;
  std::set_terminate([] {
    std::string reason = "unknown failure";
    try {
      if (const auto exception = std::current_exception()) std::rethrow_exception(exception);
    } catch (const std::bad_alloc&) {
      reason = "not enough memory";
    } catch (const std::exception& e) {
      reason = e.what();
    } catch (...) {
    }
    std::_Exit(Report(program, Failed("ended by an error that it cannot recover from: " + reason)));
  });
}

int Report(const std::string& name, const Error& error) {
  PrintNote("{}: {}\n", name, CleanText(error.message, kErrorBytesMax));
  return static_cast<int>(error.kind);
}

int RunProgram(const std::string& name, int argc, char** argv, const ProgramBody& body) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  HideTokens(argc, argv);
  RequireProcessor();
  ReportUncaughtExceptions(name);
  // A reader of our output that goes away is a write error and does not end the program.
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);  // the same of a file that would exceed a limit (ulimit -f)
  OccupyStandardStreams();
  std::stop_source termination;
  try {
    if (const auto sufficient = CheckSystemLimits(); !sufficient) return Report(name, sufficient.error());
    const TerminationSignals signals([&termination](int count) {
      if (count > 1) ::_exit(static_cast<int>(ErrorKind::kInterrupted));
      termination.request_stop();
    });
    const auto code = body(arguments, termination.get_token());
    if (!code) return Report(name, code.error());
    if (const auto written = FinishOutput(); !written && *code == 0) return Report(name, written.error());
    return *code;
  } catch (const std::system_error& e) {
    // A library that could not start a thread (std::thread).
    if (e.code() == std::errc::resource_unavailable_try_again) return Report(name, CannotStartThread(e));
    if (std::ferror(stdout) != 0) return Report(name, CannotPrint(e.code().value()));  // of fmt::print
    return Report(name, Failed(e.what()));
  } catch (const std::exception& e) {
    return Report(name, Failed(e.what()));
  }
}

std::string Environment(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr ? value : "";
}

}  // namespace tessera
