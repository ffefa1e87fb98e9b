// `tessera-coordinator`: runs a farm until it is told to stop.
#include <fmt/format.h>
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "coordinator/coordinator.h"
#include "coordinator/listener/descriptors.h"
#include "coordinator/options.h"
#include "coordinator/setup_commands.h"
#include "proto/shell/console.h"
#include "proto/shell/log.h"
#include "proto/shell/pause.h"
#include "proto/shell/program.h"
#include "proto/wire/tls_credentials.h"

namespace tessera {
namespace {

// Asks the kernel for a SIGTERM when the parent ends. Returns false if it has ended already.
bool FollowParent(pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  return ::getppid() == parent;
}

Result<int> Run(const std::vector<std::string>& arguments, std::stop_token termination) {
  const pid_t parent = ::getppid();
  if (const auto command = RunSetupCommand(arguments)) return *command;
  const auto parsed = ParseCoordinatorCommandLine(arguments);
  if (!parsed) return parsed.error();
  if (!parsed->answer.empty()) {
    fmt::print("{}", parsed->answer);
    return 0;
  }
  const CoordinatorOptions& options = parsed->options;
  StartLog(options.log_level);
  ::umask(0077);  // scenes, pictures and sockets are private to this user
  if (options.exit_with_parent && !FollowParent(parent)) return 0;
  RaiseDescriptorLimit();
  spdlog::info("coordinator_started {}", options.Text());
  const auto coordinator = Coordinator::Start(options);
  if (!coordinator) return coordinator.error();
  if (const auto http = (*coordinator)->http()) PrintNote("web page at http://{}/\n", http->Text());
  if (const auto https = (*coordinator)->https()) PrintNote("web page at https://{}/\n", https->Text());
  for (const Address& address : (*coordinator)->addresses()) PrintNote("listening on {}\n", address.Text());
  for (const StartToken& wish : options.tokens) {
    if (const auto printed = PrintStartToken(wish, (*coordinator)->addresses()); !printed)
      return printed.error();
  }
  AwaitStop(std::move(termination));
  spdlog::info("coordinator_stopping");
  (*coordinator)->Stop();
  spdlog::info("coordinator_stopped");
  return 0;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  tessera::PrepareTls();  // before there are threads
  return tessera::RunProgram("tessera-coordinator", argc, argv, tessera::Run);
}
