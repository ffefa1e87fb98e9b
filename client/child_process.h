// Child processes that never outlive this process.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

// Owns a running process. It is killed by the destructor, and by the kernel when the thread that started it
// ends, however it ends. So start processes from the main thread.
class ChildProcess {
 public:
  // Starts `program` with `arguments` (without the program's name) and appends its output to the file `log`.
  // The process gets a process group of its own, so that Ctrl-C in a terminal only reaches this one.
  static Result<ChildProcess> Start(const std::string& program, const std::vector<std::string>& arguments,
                                    const std::string& log);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ~ChildProcess();

  // Polls as readable once the process has ended.
  int ended_fd() const { return ended_fd_; }
  // Reaps the process if it has ended: "exit code 1", "signal 9 (Killed)", or else "still running".
  std::string HowEnded();
  // The last line that it logged, or "".
  std::string LastLine() const;

 private:
  ChildProcess(pid_t pid, int ended_fd, std::string log);

  pid_t pid_;  // -1: ended and reaped, or moved from
  int ended_fd_;
  std::string log_;
};

}  // namespace tessera
