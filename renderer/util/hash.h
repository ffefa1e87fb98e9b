// Counter-based random numbers: a hash of (seed, pixel, sample, dimension) takes the place of a generator's
// state, so that a sample is a pure function of its place in the picture.
#pragma once

#include <cstdint>

namespace tessera {

// A bijective mixer of 64 bits with full avalanche: the finaliser "mix13" of D. Stafford (2011), as in
// SplitMix64.
inline uint64_t MixBits(uint64_t v) {
  v ^= v >> 30;
  v *= 0xbf58476d1ce4e5b9u;
  v ^= v >> 27;
  v *= 0x94d049bb133111ebu;
  v ^= v >> 31;
  return v;
}

// The hash of all that `hash` is of, followed by more integers: ExtendHash(Hash(a), b) == Hash(a, b).
template <typename... T>
inline uint64_t ExtendHash(uint64_t hash, T... more) {
  ((hash = MixBits(hash ^ (static_cast<uint64_t>(more) + 0x9e3779b97f4a7c15u))), ...);
  return hash;
}

// A hash of several integers; the order matters.
template <typename... T>
inline uint64_t Hash(uint64_t first, T... rest) {
  return ExtendHash(0, first, rest...);
}

constexpr float kOneMinusEpsilon = 0x1.fffffep-1f;  // the largest float below 1

// Uniform in [0, 1) from the upper 24 bits: every value is a multiple of 2^-24, so never rounds up to 1.
inline float UniformFloat(uint32_t bits) {
  return static_cast<float>(bits >> 8) * 0x1p-24f;
}
// The same from the upper 24 bits of a hash.
inline float UniformFloatFromHash(uint64_t hash) {
  return UniformFloat(static_cast<uint32_t>(hash >> 32));
}

}  // namespace tessera
