// The screen of `tessera top` as lines of text.
#pragma once

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
};

// Lines that fit the terminal: totals, then jobs, those that are rendered first, then workers, those with
// problems first. What finds no place is counted.
std::vector<std::string> TopScreen(const FarmView& view, const TerminalSize& size);
// The same without limits, for programs and pipes.
std::vector<std::string> TopLines(const FarmView& view);

}  // namespace tessera
