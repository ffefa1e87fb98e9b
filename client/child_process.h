// Processes of ours that must never outlive us.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

// Owns a running process. It is killed when this object goes, and by the kernel when the thread that started
// it ends in whatever way; so start processes from the main thread.
class ChildProcess {
 public:
  // Starts `program` with `arguments` (the program's name excluded), its output appended to the file `log`,
  // in a process group of its own so that a terminal's Ctrl-C reaches only us.
  static Result<ChildProcess> Start(const std::string& program, const std::vector<std::string>& arguments,
                                    const std::string& log);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ~ChildProcess();

  // Polls as readable once the process has ended.
  int ended_fd() const { return ended_fd_; }
  // Takes leave of a process that has ended: "exit code 1", "signal 9 (Killed)".
  std::string HowEnded();
  // The last line it logged, or "".
  std::string LastWords() const;

 private:
  ChildProcess(pid_t pid, int ended_fd, std::string log);

  pid_t pid_;  // -1: gone
  int ended_fd_;
  std::string log_;
};

}  // namespace tessera
