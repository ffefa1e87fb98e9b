// Repeatable random numbers of a simulation: one stream per seed.
#pragma once

#include <cstdint>

#include "coordinator/core/schedule/instant.h"
#include "renderer/util/hash.h"

namespace tessera {

class Random {
 public:
  explicit Random(uint64_t seed) : seed_(seed) {}
  uint64_t Next() { return Hash(seed_, ++count_); }
  // In [low, high].
  int Int(int low, int high) {
    return low + static_cast<int>(Next() % static_cast<uint64_t>(high - low + 1));
  }
  double Real(double low, double high) {
    return low + (high - low) * static_cast<double>(Next() >> 11) * 0x1p-53;
  }
  bool Chance(double probability) { return Real(0, 1) < probability; }
  Instant Duration(double low_s, double high_s) { return FromSeconds(Real(low_s, high_s)); }

 private:
  uint64_t seed_;
  uint64_t count_ = 0;
};

}  // namespace tessera
