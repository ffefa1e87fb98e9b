// What the farm acknowledged, from the workers' own logs: the witness that nothing was acknowledged twice.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "film/sample_range.h"

namespace tessera {

// A result that a worker was told is merged, for a unit that adds samples.
struct Acknowledgement {
  uint64_t job = 0;
  uint32_t frame = 0, tile = 0;
  SampleRange range;
  std::string time;  // of the worker's log; sorts by time
};

// Those that a worker's log (--log-level debug) tells of. A line that is cut off is none.
std::vector<Acknowledgement> ReadAcknowledgements(const std::string& log);

// How many of them name a result all of whose samples had been acknowledged before: the farm had lost what it
// said it had. `all` in any order. Results whose acknowledgement a worker's death kept out of its log are not
// seen.
size_t CountRenderedAgain(std::vector<Acknowledgement> all);

}  // namespace tessera
