#include "client/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr uint64_t kLogSizeMax = 64 << 20;

// glibc 2.36 declares its own wrapper without C linkage.
int OpenPidfd(pid_t pid) {
  return static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
}

// Runs in the child between fork and exec: only calls that are safe there (signal-safety(7)). Returns on
// failure.
void BecomeProgram(char* const* arguments, int log_fd, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);  // the parent ended before the line above
  ::setpgid(0, 0);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int null_fd = ::open("/dev/null", O_RDONLY);
  if (null_fd < 0 || ::dup2(null_fd, STDIN_FILENO) < 0 || ::dup2(log_fd, STDOUT_FILENO) < 0 ||
      ::dup2(log_fd, STDERR_FILENO) < 0) {
    return;
  }
  ::execv(arguments[0], arguments);
}

// Returns the errno with which the child failed to execute the program, or 0.
int AwaitExec(int report_fd) {
  int reason = 0;
  ssize_t got = 0;
  do {
    // Returns 0 bytes at exec, which closes the other end.
    got = ::read(report_fd, &reason, sizeof reason);
  } while (got < 0 && errno == EINTR);
  return got == sizeof reason ? reason : 0;
}

}  // namespace

ChildProcess::ChildProcess(pid_t pid, int ended_fd, std::string log)
    : pid_(pid), ended_fd_(ended_fd), log_(std::move(log)) {}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      ended_fd_(std::exchange(other.ended_fd_, -1)),
      log_(std::move(other.log_)) {}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  if (ended_fd_ >= 0) ::close(ended_fd_);
}

Result<ChildProcess> ChildProcess::Start(const std::string& program,
                                         const std::vector<std::string>& arguments, const std::string& log) {
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const int log_fd = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  int report[2] = {-1, -1};
  if (log_fd < 0 || ::pipe2(report, O_CLOEXEC) != 0) {
    const int reason = errno;
    if (log_fd >= 0) ::close(log_fd);
    return Failed(
        fmt::format("{}: cannot start the program with log {}: {}", program, log, std::strerror(reason)));
  }
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid == 0) {
    BecomeProgram(argv.data(), log_fd, parent);
    const int reason = errno;
    [[maybe_unused]] const ssize_t written = ::write(report[1], &reason, sizeof reason);
    ::_exit(127);
  }
  const int fork_reason = errno;
  ::close(log_fd);
  ::close(report[1]);
  const int reason = pid < 0 ? fork_reason : AwaitExec(report[0]);
  ::close(report[0]);
  if (pid < 0) return Failed(fmt::format("{}: cannot start the program: {}", program, std::strerror(reason)));
  ChildProcess process(pid, OpenPidfd(pid), log);
  if (reason != 0)
    return Failed(fmt::format("{}: cannot start the program: {}", program, std::strerror(reason)));
  if (process.ended_fd_ < 0)
    return Failed(fmt::format("{}: cannot monitor the process: {}", program, std::strerror(errno)));
  return process;
}

std::string ChildProcess::HowEnded() {
  int status = 0;
  if (pid_ <= 0 || ::waitpid(pid_, &status, WNOHANG) != pid_) return "still running";
  pid_ = -1;
  if (WIFSIGNALED(status))
    return fmt::format("signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)));
  return fmt::format("exit code {}", WEXITSTATUS(status));
}

std::string ChildProcess::LastLine() const {
  const auto text = ReadFile(log_, kLogSizeMax);
  if (!text) return {};
  const size_t end = text->find_last_not_of(" \n");
  if (end == std::string::npos) return {};
  const size_t begin = text->rfind('\n', end);
  return text->substr(begin == std::string::npos ? 0 : begin + 1,
                      end - (begin == std::string::npos ? -1 : begin));
}

}  // namespace tessera
