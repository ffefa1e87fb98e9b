// One run of chaos: its options and its report.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tessera {

struct ChaosOptions {
  uint64_t seed = 1;
  double seconds = 0;
  std::vector<std::string> faults;  // names; none: all
  int each = 0;                     // how often each of them is injected at least
  int pause_ms = 225;               // between two faults, on average
  int workers = 6;
  int samples_per_pixel = 512;
  bool small_disk = false;
};

struct ChaosReport {
  std::string skipped;         // the reason if the run was skipped, or empty
  std::string faults;          // that were injected
  int pictures = 0;            // compared with undisturbed renders
  int pictures_again = 0;      // of these, fetched again at the end
  int jobs_lost = 0;           // that were submitted after the backup to which a farm was restored
  int deadly_jobs = 0;         // that failed because they kill their workers
  int memory_kills = 0;        // workers that took too much memory
  int stalls = 0, probes = 0;  // calls that stalled for long enough; clients that had to be answered
  std::string noticed;         // what coordinators logged about faults
  size_t acknowledged = 0, rendered_again = 0;
  std::vector<std::string> problems;

  bool Passed() const { return problems.empty(); }
  std::string Text() const;
};

// Injects faults until the time is over and each has been injected often enough. Then all processes come
// back, and the open jobs must finish.
ChaosReport RunChaos(const ChaosOptions& options);

}  // namespace tessera
