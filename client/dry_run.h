// --dry-run: what a command would send and render, and about how long that takes.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "client/cancellation.h"
#include "client/scene_job.h"
#include "proto/terms.h"

namespace tessera {

// The workers of a farm that may render a job.
struct FarmCapacity {
  std::string coordinator;
  size_t workers = 0;
  uint64_t threads = 0;
  size_t jobs_ahead = 0;  // open jobs of the same or a higher priority
};
FarmCapacity CapacityFor(const std::string& coordinator, const std::set<std::string>& required_tags,
                         int priority, const std::vector<WorkerStatus>& workers,
                         const std::vector<JobStatus>& jobs);

// What is known of a job before it runs.
struct Forecast {
  size_t frames = 0;
  int width = 0, height = 0;       // of the first frame
  uint32_t samples_per_pixel = 0;  // of the first frame; the maximum if it is adaptive
  bool is_adaptive = false;
  uint64_t samples = 0;  // of all frames, at most
  size_t files = 0;
  uint64_t file_bytes = 0;
  // Measured on this machine by loading and rendering a part of the first frame.
  int threads = 0;
  double load_s = 0;
  double samples_per_second = 0;
  uint64_t memory_bytes = 0;  // the peak of this process
  std::optional<FarmCapacity> farm;

  double seconds() const { return load_s + static_cast<double>(samples) / samples_per_second; }
  // On the farm, if its threads are as fast as those of this machine and it has nothing else to do; nullopt
  // if no worker may render the job.
  std::optional<double> farm_seconds() const;
};

// Reads all frames, builds the first scene and renders it for about `probe`. Fails as rendering would.
Result<Forecast> MakeForecast(const SceneOptions& options, int threads, std::chrono::milliseconds probe,
                              Cancellation& cancellation);

std::string ForecastText(const Forecast& forecast);
std::string ForecastJson(const Forecast& forecast);

}  // namespace tessera
