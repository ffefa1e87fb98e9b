// Shows the progress of several jobs on stderr.
#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <string>

#include "proto/terms.h"

namespace tessera {

// On a terminal, a line for each job that is rewritten in place, and "and N more" if there is no room for
// all; in a log, a line for each job that made progress, every few seconds. Thread safe.
class ProgressBoard {
 public:
  ProgressBoard();
  ~ProgressBoard();
  ProgressBoard(const ProgressBoard&) = delete;
  ProgressBoard& operator=(const ProgressBoard&) = delete;
  // Shows the line of a job, unless the board was written a moment ago. The line of a job that has ended is
  // always shown.
  void Show(JobId job, const std::string& line, bool has_ended);

 private:
  struct Line {
    std::string text;
    bool is_new = true;  // not written since it changed
    bool has_ended = false;
  };
  void WriteTerminal();
  void WriteLog();

  const bool terminal_;
  std::mutex mutex_;
  std::map<JobId, Line> lines_;                 // guarded by mutex_
  int rows_ = 0;                                // of the terminal that the board takes; guarded by mutex_
  std::chrono::steady_clock::time_point next_;  // guarded by mutex_
};

}  // namespace tessera
