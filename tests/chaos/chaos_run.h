// One run of chaos: what is done, and what came of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tessera {

struct ChaosOptions {
  uint64_t seed = 1;
  double seconds = 0;
  int worker_faults = 0, coordinator_faults = 0;
  int workers = 4;
  int samples_per_pixel = 512;
  bool small_disk = false;
};

struct ChaosReport {
  std::string skipped;  // why nothing was done, or empty
  int worker_kills = 0, worker_stops = 0, worker_drains = 0;
  int coordinator_kills = 0, coordinator_stops = 0, disk_fills = 0;
  int pictures = 0;  // compared with the undisturbed ones
  size_t acknowledged = 0, rendered_again = 0;
  std::vector<std::string> problems;

  bool Passed() const { return problems.empty(); }
  std::string Text() const;
};

// Faults go on until the time is over and their numbers are reached; then everything comes back, and the jobs
// that are open must end.
ChaosReport RunChaos(const ChaosOptions& options);

}  // namespace tessera
