// What the farm acknowledged, from the workers' own logs: the witness that nothing was acknowledged twice.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "renderer/film/sample_range.h"

namespace tessera {

// A result that a worker was told is merged, for a unit that adds samples.
struct Acknowledgement {
  uint64_t job = 0;
  uint32_t frame = 0, tile = 0;
  SampleRange range;
  std::string time;  // of the worker's log
};

// Those that a worker's log (--log-level debug) tells of. A line that is cut off is none.
std::vector<Acknowledgement> ReadAcknowledgements(const std::string& log);

// Those whose samples are all in others: in whatever order they came, one of them brought nothing that had
// not been acknowledged, so the farm had lost what it said it had. `all` in any order: the times are those at
// which workers wrote, and one that was stopped writes late. Results whose acknowledgement a worker's death
// kept out of its log are not seen.
std::vector<Acknowledgement> RenderedAgain(std::vector<Acknowledgement> all);

}  // namespace tessera
