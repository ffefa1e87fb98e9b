// How long to wait before trying again.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "renderer/util/hash.h"

namespace tessera {

constexpr std::chrono::milliseconds kBackoffFirst{50};
// The whole farm is back soon after its coordinator has restarted.
constexpr std::chrono::milliseconds kBackoffMax{10'000};

// Exponential back-off from `first` to `max` with jitter: each wait is a random part, at least a half, of the
// full wait, so that the workers of a farm do not all come back at the same moment. The same seed gives the
// same waits. Not thread safe.
class Backoff {
 public:
  explicit Backoff(uint64_t seed, std::chrono::milliseconds first = kBackoffFirst,
                   std::chrono::milliseconds max = kBackoffMax)
      : seed_(seed), first_(first), max_(max) {}
  std::chrono::milliseconds Next() {
    const auto full = std::min(first_ * (int64_t{1} << std::min(failures_, 20)), max_);
    ++failures_;
    const float part = 0.5f + 0.5f * UniformFloat(static_cast<uint32_t>(Hash(seed_, draws_++)));
    return std::chrono::milliseconds(static_cast<int64_t>(static_cast<float>(full.count()) * part));
  }
  // Starts again from the shortest wait: call it after a success.
  void Reset() { failures_ = 0; }

 private:
  uint64_t seed_;
  std::chrono::milliseconds first_, max_;
  uint64_t draws_ = 0;
  int failures_ = 0;
};

}  // namespace tessera
