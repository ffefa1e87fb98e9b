// Runs the programs under test.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

// For anything that a test waits for; machines may be loaded.
constexpr std::chrono::seconds kProcessPatience{120};

// A running program, killed by the destructor.
class Process {
 public:
  // `program` is one of build/PRESET/bin, or an absolute path. It runs in `folder`, writes its output to
  // files there, creates its temporary folders in `folder`/tmp, and has its local sockets and logins in
  // `folder`.
  Process(const std::string& folder, const std::string& program, const std::vector<std::string>& arguments);
  ~Process();
  Process(Process&& other) noexcept;
  Process& operator=(Process&&) = delete;

  pid_t pid() const { return pid_; }
  void Signal(int number) const;
  // Waits for the program to end. Returns its exit code or minus the number of the signal that ended it, or
  // nullopt if that takes too long.
  std::optional<int> Wait(std::chrono::milliseconds patience = kProcessPatience);
  std::string Output() const;
  std::string Errors() const;
  // Waits until stderr contains `text`. Returns false if the program ends before, or on timeout.
  bool AwaitErrors(const std::string& text);

 private:
  pid_t pid_ = -1;
  int ended_fd_ = -1;
  std::string output_path_, errors_path_;
};

struct Outcome {
  int code = 0;  // or minus the number of a signal; 1000: timeout
  std::string output, errors;
};

// Runs a program until it ends.
Outcome RunProgram(const std::string& folder, const std::string& program,
                   const std::vector<std::string>& arguments);

// Runs a command of bash, in which $tessera is the client, until it ends.
Outcome RunShell(const std::string& folder, const std::string& command);

// The running children of `parent`.
std::vector<pid_t> ChildrenOf(pid_t parent);
// The running children of `parent` that execute `program`.
std::vector<pid_t> ChildrenOf(pid_t parent, const std::string& program);
bool IsAlive(pid_t pid);

// Polls `condition` until it is true. Returns false on timeout. Only for conditions that nothing else can
// wait for.
template <typename Condition>
bool Eventually(Condition condition, std::chrono::milliseconds patience = kProcessPatience);

}  // namespace tessera

#include <thread>

#include "tests/sanitizers.h"

namespace tessera {

template <typename Condition>
bool Eventually(Condition condition, std::chrono::milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + kSlowdown * patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace tessera
