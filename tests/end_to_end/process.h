// Programs under test, as processes.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

constexpr std::chrono::seconds kProcessPatience{
    120};  // for anything a test waits for: machines may be loaded

// A running program of ours. Killed, with its descendants' help, when it goes out of scope.
class Process {
 public:
  // `program` is one of build/PRESET/bin; its output goes to files in `folder`, where it also runs.
  // Its own temporary folders go to `folder`/tmp.
  Process(const std::string& folder, const std::string& program, const std::vector<std::string>& arguments);
  ~Process();
  Process(Process&& other) noexcept;
  Process& operator=(Process&&) = delete;

  pid_t pid() const { return pid_; }
  void Signal(int number) const;
  // Waits for the end: the exit code, or minus the signal's number. Nothing if it takes too long.
  std::optional<int> Wait(std::chrono::milliseconds patience = kProcessPatience);
  std::string Output() const;
  std::string Errors() const;
  // Waits until its standard error holds `text`; whether it came before the program's end.
  bool AwaitErrors(const std::string& text);

 private:
  pid_t pid_ = -1;
  int ended_fd_ = -1;
  std::string output_path_, errors_path_;
};

struct Outcome {
  int code = 0;  // or minus the signal's number; 1000: took too long
  std::string output, errors;
};

// Runs a program to its end.
Outcome RunProgram(const std::string& folder, const std::string& program,
                   const std::vector<std::string>& arguments);

// The processes that `parent` started and that have not ended.
std::vector<pid_t> ChildrenOf(pid_t parent);
// Of those, the ones whose program is `program`.
std::vector<pid_t> ChildrenOf(pid_t parent, const std::string& program);
bool IsAlive(pid_t pid);

// Calls `condition` now and then until it is true; false if that takes too long. For conditions that cannot
// be waited for.
template <typename Condition>
bool Eventually(Condition condition, std::chrono::milliseconds patience = kProcessPatience);

}  // namespace tessera

#include <thread>

namespace tessera {

template <typename Condition>
bool Eventually(Condition condition, std::chrono::milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace tessera
