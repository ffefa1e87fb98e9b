#include "tests/end_to_end/process.h"
#include "tests/build_paths.h"
#include "tests/sanitizers.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

namespace tessera {
namespace {

std::string Slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// A file name that no other process of this test program has used.
std::string Unique(const std::string& folder, const std::string& program) {
  static std::atomic<int> count = 0;
  return folder + "/" + program + "-" + std::to_string(count++);
}

void BecomeProgram(const std::string& folder, const std::vector<char*>& words, const std::string& output,
                   const std::string& errors) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int out = ::open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int err = ::open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (out < 0 || err < 0 || ::chdir(folder.c_str()) != 0) return;
  ::setenv("TMPDIR", (folder + "/tmp").c_str(), 1);
  ::setenv("XDG_RUNTIME_DIR", (folder + "/run").c_str(), 1);
  ::setenv("XDG_STATE_HOME", (folder + "/state").c_str(), 1);
  ::setenv("XDG_CACHE_HOME", (folder + "/user-cache").c_str(), 1);
  ::setenv("XDG_CONFIG_HOME", (folder + "/config").c_str(), 1);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  ::execv(words[0], words.data());
}

}  // namespace

Process::Process(const std::string& folder, const std::string& program,
                 const std::vector<std::string>& arguments) {
  const std::string name = Unique(folder, std::filesystem::path(program).filename());
  output_path_ = name + ".out";
  errors_path_ = name + ".err";
  std::string path = program.starts_with('/') ? program : BinaryDir() + "/bin/" + program;
  std::vector<char*> words{path.data()};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  pid_ = ::fork();
  if (pid_ == 0) {
    BecomeProgram(folder, words, output_path_, errors_path_);
    ::_exit(127);
  }
  ended_fd_ = static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0));
  EXPECT_GE(ended_fd_, 0);
}

Process::Process(Process&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      ended_fd_(std::exchange(other.ended_fd_, -1)),
      output_path_(other.output_path_),
      errors_path_(other.errors_path_) {}

Process::~Process() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  if (ended_fd_ >= 0) ::close(ended_fd_);
}

void Process::Signal(int number) const {
  EXPECT_EQ(::kill(pid_, number), 0);
}

std::optional<int> Process::Wait(std::chrono::milliseconds patience) {
  pollfd event{ended_fd_, POLLIN, 0};
  if (::poll(&event, 1, static_cast<int>(kSlowdown * patience.count())) != 1) return std::nullopt;
  int status = 0;
  EXPECT_EQ(::waitpid(pid_, &status, 0), pid_);
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

std::string Process::Output() const {
  return Slurp(output_path_);
}
std::string Process::Errors() const {
  return Slurp(errors_path_);
}

bool Process::AwaitErrors(const std::string& text) {
  pollfd event{ended_fd_, POLLIN, 0};
  const auto has_it = [&] { return Errors().find(text) != std::string::npos; };
  Eventually([&] { return has_it() || ::poll(&event, 1, 0) == 1; });
  return has_it();
}

Outcome RunProgram(const std::string& folder, const std::string& program,
                   const std::vector<std::string>& arguments) {
  Process process(folder, program, arguments);
  constexpr int kTooLong = 1000;
  const int code = process.Wait().value_or(kTooLong);
  return {code, process.Output(), process.Errors()};
}

Outcome RunShell(const std::string& folder, const std::string& command) {
  return RunProgram(folder, "/bin/bash", {"-c", "tessera=" + BinaryDir() + "/bin/tessera; " + command});
}

std::vector<pid_t> ChildrenOf(pid_t parent) {
  const std::string pid = std::to_string(parent);
  std::istringstream text(Slurp("/proc/" + pid + "/task/" + pid + "/children"));
  std::vector<pid_t> children;
  for (pid_t child = 0; text >> child;) children.push_back(child);
  return children;
}

std::vector<pid_t> ChildrenOf(pid_t parent, const std::string& program) {
  std::vector<pid_t> children = ChildrenOf(parent);
  std::erase_if(children, [&](pid_t child) {
    std::error_code error;
    const auto path = std::filesystem::read_symlink("/proc/" + std::to_string(child) + "/exe", error);
    return error || path.filename() != program;
  });
  return children;
}

bool IsAlive(pid_t pid) {
  const std::string status = Slurp("/proc/" + std::to_string(pid) + "/stat");
  return !status.empty() && status.find(") Z") == std::string::npos;
}

}  // namespace tessera
