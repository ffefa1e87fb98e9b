// The screen of `tessera top` as lines of text.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/terminal.h"
#include "proto/terms.h"

namespace tessera {

// What a screen shows.
struct FarmView {
  std::string address;
  std::vector<JobStatus> jobs;
  std::vector<WorkerStatus> workers;
  // That are not in the lists because the answer would be too large.
  uint64_t jobs_left_out = 0, workers_left_out = 0;
};

// Lines that fit the terminal: totals, then jobs, those that are rendered first, then workers, those with
// problems first. What finds no place is counted.
std::vector<std::string> TopScreen(const FarmView& view, const TerminalSize& size);
// The same without limits, for programs and pipes.
std::vector<std::string> TopLines(const FarmView& view);

}  // namespace tessera
