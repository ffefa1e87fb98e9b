#include "client/notify_command.h"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "proto/shell/console.h"

namespace tessera {
namespace {

std::vector<std::string> EnvironmentWith(const Notice& notice) {
  std::vector<std::string> all;
  for (char** each = environ; *each != nullptr; ++each) all.emplace_back(*each);
  const std::pair<const char*, const std::string&> added[] = {{"TESSERA_JOB_ID=", notice.job},
                                                              {"TESSERA_JOB_NAME=", notice.name},
                                                              {"TESSERA_JOB_STATE=", notice.state},
                                                              {"TESSERA_JOB_REASON=", notice.reason}};
  for (const auto& [variable, value] : added) {
    std::erase_if(all, [&start = variable](const std::string& each) { return each.starts_with(start); });
    std::string clean = value;
    std::erase(clean, '\0');
    all.push_back(variable + clean);
  }
  return all;
}

// Starts the shell. Returns 0 or the number of an error.
int Spawn(const std::string& command, const Notice& notice, pid_t& pid) {
  std::vector<std::string> variables = EnvironmentWith(notice);
  std::vector<char*> environment;
  environment.reserve(variables.size() + 1);
  for (std::string& each : variables) environment.push_back(each.data());
  environment.push_back(nullptr);
  std::string shell = "sh", option = "-c", text = command;
  char* const arguments[] = {shell.data(), option.data(), text.data(), nullptr};
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_adddup2(&files, STDERR_FILENO, STDOUT_FILENO);
  ::posix_spawnattr_init(&attributes);
  // This program blocks the signals that end it and ignores others, which children would inherit.
  sigset_t none, ignored;
  sigemptyset(&none);
  sigemptyset(&ignored);
  sigaddset(&ignored, SIGPIPE);
  sigaddset(&ignored, SIGXFSZ);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setsigdefault(&attributes, &ignored);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  const int error = ::posix_spawn(&pid, "/bin/sh", &files, &attributes, arguments, environment.data());
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&files);
  return error;
}

}  // namespace

Notice NoticeOf(const JobStatus& status) {
  return {std::to_string(Number(status.job)), status.name, std::string(JobStateName(status.state)),
          status.state == JobState::kFinished ? "" : status.reason};
}

void RunNotifyCommand(const std::string& command, const Notice& notice) {
  if (command.empty()) return;
  pid_t pid = -1;
  if (const int error = Spawn(command, notice, pid); error != 0)
    return PrintNote("tessera: warning: --notify-command cannot be run: {}\n", std::strerror(error));
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status)) {
    PrintNote("tessera: warning: --notify-command was ended by signal {}\n", WTERMSIG(status));
  } else if (WEXITSTATUS(status) != 0) {
    PrintNote("tessera: warning: --notify-command ended with exit code {}\n", WEXITSTATUS(status));
  }
}

}  // namespace tessera
