// The Halton sequence: van der Corput's radical inverse in a different prime base for each dimension.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderer/util/hash.h"

namespace tessera {

// Further dimensions are in such large bases that few numbers of samples are stratified in them.
constexpr int kHaltonDimensions = 128;

// The prime base of a dimension, with as many digits as a fraction of 32 bits needs.
struct HaltonBase {
  uint32_t base = 2;
  int digits = 32;
  double unit = 0;  // base^-digits
};
const std::array<HaltonBase, kHaltonDimensions>& HaltonBases();

// The fraction whose digits in this base are those of `index` in reverse order, each first mapped by
// permute(position, digit, digits before it reversed), in [0, 1).
template <typename Permute>
float PermutedRadicalInverse(const HaltonBase& base, uint64_t index, Permute permute) {
  uint64_t reversed = 0;
  for (int position = 0; position < base.digits; ++position) {
    const uint64_t next = index / base.base;
    const auto digit = static_cast<uint32_t>(index - next * base.base);
    reversed = reversed * base.base + permute(position, digit, reversed);
    index = next;
  }
  const float value = static_cast<float>(static_cast<double>(reversed) * base.unit);
  return value < kOneMinusEpsilon ? value : kOneMinusEpsilon;
}

inline float RadicalInverse(const HaltonBase& base, uint64_t index) {
  return PermutedRadicalInverse(base, index, [](int, uint32_t digit, uint64_t) { return digit; });
}

// Owen's nested scrambling: the permutation of a digit depends on all digits before it.
float OwenRadicalInverse(const HaltonBase& base, uint64_t index, uint64_t seed);

// RadicalInverse with one random permutation for each position of each base. Immutable.
class DigitPermutations {
 public:
  explicit DigitPermutations(uint64_t seed);

  float RadicalInverse(int dimension, uint64_t index) const {
    const Dimension& d = dimensions_[static_cast<size_t>(dimension)];
    const uint16_t* table = reversed_.data() + d.start;
    uint64_t reversed = 0;
    for (int i = 0; i < d.groups; ++i, table += d.size) {
      const uint64_t next = index / d.size;
      reversed = reversed * d.size + table[index - next * d.size];
      index = next;
    }
    const float value = static_cast<float>(static_cast<double>(reversed) * d.unit);
    return value < kOneMinusEpsilon ? value : kOneMinusEpsilon;
  }

 private:
  // Several digits of a small base are looked up together.
  struct Dimension {
    size_t start = 0;   // in reversed_: one table for each group
    uint32_t size = 2;  // a power of the base: the number of values of a group
    int groups = 0;
    double unit = 0;  // size^-groups
  };
  void AddGroup(const HaltonBase& base, int digits, const Dimension& dimension, uint64_t seed);

  std::array<Dimension, kHaltonDimensions> dimensions_;
  std::vector<uint16_t> reversed_;  // the permuted digits of a group in reverse order
};

}  // namespace tessera
