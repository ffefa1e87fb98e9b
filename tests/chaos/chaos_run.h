// One run of chaos: its options and its report.
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
  std::string skipped;  // the reason if the run was skipped, or empty
  int worker_kills = 0, worker_stops = 0, worker_drains = 0;
  int coordinator_kills = 0, coordinator_stops = 0, disk_fills = 0;
  int bit_flips = 0;  // in pictures, blobs and caches
  int pictures = 0;   // compared with undisturbed renders
  size_t acknowledged = 0, rendered_again = 0;
  std::vector<std::string> problems;

  bool Passed() const { return problems.empty(); }
  std::string Text() const;
};

// Injects faults until the time is over and the requested numbers of faults are reached. Then all processes
// come back, and the open jobs must finish.
ChaosReport RunChaos(const ChaosOptions& options);

}  // namespace tessera
