// tessera-coordinator: see options.cpp for its command line.
#include <signal.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cstdio>

#include "coordinator/coordinator.h"
#include "coordinator/options.h"
#include "renderer/util/processor.h"

namespace {

int Fail(const tessera::Error& error) {
  std::fprintf(stderr, "tessera-coordinator: %s\n", error.message.c_str());
  return static_cast<int>(error.kind);
}

void StartLog(const std::string& level) {
  auto logger = spdlog::stderr_logger_mt("coordinator");
  logger->set_pattern("%Y-%m-%dT%H:%M:%S.%e %l %v");
  logger->set_level(spdlog::level::from_str(level));
  spdlog::set_default_logger(std::move(logger));
}

// Signals are waited for, in one place: no thread is interrupted by them.
void BlockSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGPIPE, SIG_IGN);
}

// Asks the kernel for a SIGTERM at the parent's end. False if it has ended already.
bool FollowParent(pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  return getppid() == parent;
}

}  // namespace

int main(int argc, char** argv) {
  tessera::RequireProcessor();
  const pid_t parent = getppid();
  const auto options = tessera::ParseCoordinatorOptions(argc, argv);
  if (!options) return Fail(options.error());
  if (!options->has_value()) return 0;
  StartLog((*options)->log_level);
  BlockSignals();
  if ((*options)->exit_with_parent && !FollowParent(parent)) return 0;
  spdlog::info("coordinator_started {}", (*options)->Text());
  const auto run = tessera::RunCoordinator(**options);
  if (!run) return Fail(run.error());
  spdlog::info("coordinator_stopped");
  return 0;
}
