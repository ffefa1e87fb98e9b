#include "renderer/sampler/halton.h"

#include "renderer/sampler/sobol.h"

namespace tessera {
namespace {

std::array<HaltonBase, kHaltonDimensions> MakeBases() {
  constexpr uint64_t kFraction = uint64_t{1} << 32;
  std::array<HaltonBase, kHaltonDimensions> bases;
  int count = 0;
  for (uint32_t candidate = 2; count < kHaltonDimensions; ++candidate) {
    bool is_prime = true;
    for (int i = 0; i < count; ++i)
      is_prime = is_prime && candidate % bases[static_cast<size_t>(i)].base != 0;
    if (!is_prime) continue;
    HaltonBase base{candidate, 0, 0};
    uint64_t power = 1;
    for (; power < kFraction; power *= candidate) ++base.digits;
    base.unit = 1 / static_cast<double>(power);
    bases[static_cast<size_t>(count++)] = base;
  }
  return bases;
}

}  // namespace

const std::array<HaltonBase, kHaltonDimensions>& HaltonBases() {
  static const std::array<HaltonBase, kHaltonDimensions> bases = MakeBases();
  return bases;
}

float OwenRadicalInverse(const HaltonBase& base, uint64_t index, uint64_t seed) {
  return PermutedRadicalInverse(base, index, [&](int position, uint32_t digit, uint64_t before) {
    const uint64_t hash = Hash(seed, position, before);
    return PermutationElement(digit, base.base, static_cast<uint32_t>(hash));
  });
}

// The digit at a position is permuted by the hash of (seed, position).
void DigitPermutations::AddGroup(const HaltonBase& base, int digits, const Dimension& dimension,
                                 uint64_t seed) {
  for (uint32_t value = 0; value < dimension.size; ++value) {
    uint32_t reversed = 0, rest = value;
    for (int i = 0; i < digits; ++i, rest /= base.base) {
      const auto hash = static_cast<uint32_t>(Hash(seed, i));
      reversed = reversed * base.base + PermutationElement(rest % base.base, base.base, hash);
    }
    reversed_.push_back(static_cast<uint16_t>(reversed));
  }
}

DigitPermutations::DigitPermutations(uint64_t seed) {
  constexpr uint32_t kGroupMax = 1024;  // values: keeps the tables of all dimensions within the cache
  for (size_t i = 0; i < dimensions_.size(); ++i) {
    const HaltonBase& base = HaltonBases()[i];
    Dimension& dimension = dimensions_[i];
    int digits = 1;
    for (dimension.size = base.base; dimension.size * base.base <= kGroupMax; dimension.size *= base.base)
      ++digits;
    dimension.start = reversed_.size();
    dimension.unit = 1;
    for (int covered = 0; covered < base.digits; covered += digits, ++dimension.groups) {
      AddGroup(base, digits, dimension, Hash(seed, i, dimension.groups));
      dimension.unit /= dimension.size;
    }
  }
}

}  // namespace tessera
