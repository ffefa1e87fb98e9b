// How long to wait before trying again.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "renderer/util/hash.h"

namespace tessera {

constexpr std::chrono::milliseconds kBackoffFirst{50};
constexpr std::chrono::milliseconds kBackoffMax{10'000};  // a restarted coordinator has its whole farm soon

// Doubles from kBackoffFirst to kBackoffMax; each wait is a random part, from a half on, of that, so that a
// farm's workers do not come back all at once. The same seed gives the same waits. Not thread safe.
class Backoff {
 public:
  explicit Backoff(uint64_t seed) : seed_(seed) {}
  std::chrono::milliseconds Next() {
    const auto full = std::min(kBackoffFirst * (int64_t{1} << std::min(failures_, 20)), kBackoffMax);
    ++failures_;
    const float part = 0.5f + 0.5f * UniformFloat(static_cast<uint32_t>(Hash(seed_, draws_++)));
    return std::chrono::milliseconds(static_cast<int64_t>(static_cast<float>(full.count()) * part));
  }
  // Something succeeded.
  void Reset() { failures_ = 0; }

 private:
  uint64_t seed_;
  uint64_t draws_ = 0;
  int failures_ = 0;
};

}  // namespace tessera
