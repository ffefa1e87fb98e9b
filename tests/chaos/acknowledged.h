// The results that the farm acknowledged, as the workers logged them. Shows that nothing was acknowledged
// twice.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "renderer/film/sample_range.h"

namespace tessera {

// A result that the coordinator acknowledged to a worker as merged.
struct Acknowledgement {
  std::string farm;  // its identity
  uint64_t job = 0;
  uint32_t frame = 0, tile = 0;
  SampleRange range;
  std::string time;  // of the worker's log
  // How often the farm had been restored to an earlier state before. What was acknowledged since that state
  // has to be rendered again.
  int restores = 0;
};

// Reads the acknowledgements in a worker's log (--log-level debug). Ignores a truncated line.
std::vector<Acknowledgement> ReadAcknowledgements(const std::string& log);

// Returns the results whose samples are all in other results. In whatever order they were merged, one of them
// added only samples that had been acknowledged before, so the farm had lost an acknowledged result. `all`
// may be in any order: the times are those of the workers' log lines, and a stopped worker writes late.
// Acknowledgements that a worker did not log before it was killed are missing.
std::vector<Acknowledgement> RenderedAgain(std::vector<Acknowledgement> all);

}  // namespace tessera
