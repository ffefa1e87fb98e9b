// Random numbers that are a function of rays and directions, for decisions that a sampler's well-distributed
// numbers are too few for.
#pragma once

#include <bit>
#include <cstdint>

#include "renderer/math/vec.h"
#include "renderer/util/hash.h"

namespace tessera {

// The hash of all that `hash` is of, followed by the bits of two vectors.
inline uint64_t ExtendHash(uint64_t hash, Vec3 a, Vec3 b) {
  const auto pair = [](float x, float y) {
    return uint64_t{std::bit_cast<uint32_t>(x)} << 32 | std::bit_cast<uint32_t>(y);
  };
  return ExtendHash(hash, pair(a.x, a.y), pair(a.z, b.x), pair(b.y, b.z));
}
inline uint64_t Hash(Vec3 a, Vec3 b) {
  return ExtendHash(0, a, b);
}

// An endless stream of independent numbers, uniform in [0, 1), from a seed: SplitMix64 (G. Steele, D. Lea, C.
// Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
class RandomStream {
 public:
  RandomStream() = default;
  explicit RandomStream(uint64_t seed) : state_(seed) {}

  float Next() {
    state_ += 0x9e3779b97f4a7c15u;
    return UniformFloatFromHash(MixBits(state_));
  }
  Point2 Next2() {
    const float x = Next();
    const float y = Next();
    return {x, y};
  }

 private:
  uint64_t state_ = 0;
};

}  // namespace tessera
