// Workers that render nothing: they take leases of a real coordinator over real connections and return
// made-up tiles at once, as fast as it takes them.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "proto/wire/endpoint.h"
#include "renderer/film/channel_layout.h"

namespace tessera {

struct LoadCounts {
  uint64_t results = 0;  // answered, of any verdict
  uint64_t accepted = 0;
  uint64_t bytes = 0;  // of encoded tiles
  uint64_t calls = 0;  // of ReturnResults
};

// Each has a connection of its own. Thread safe.
class SyntheticWorkers {
 public:
  // `unit_seconds` is what they say that one sample of a tile took to render: it decides how the scheduler
  // cuts. `shape` is that of the frame: R, G, B and the weight, unless it has layers.
  SyntheticWorkers(const Endpoint& coordinator, int count, int slots, double unit_seconds,
                   const PixelShape& shape = {4});
  // Stops all of them and waits for their last calls.
  ~SyntheticWorkers();
  SyntheticWorkers(const SyntheticWorkers&) = delete;
  SyntheticWorkers& operator=(const SyntheticWorkers&) = delete;

  LoadCounts counts() const;
  // The first error that any of them met and that is not to be tried again, or empty.
  std::string error() const;

 private:
  class One;
  struct Shared;
  std::unique_ptr<Shared> shared_;
  std::vector<std::unique_ptr<One>> all_;
};

}  // namespace tessera
