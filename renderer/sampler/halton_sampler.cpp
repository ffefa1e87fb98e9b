#include "renderer/sampler/halton_sampler.h"

#include <algorithm>

namespace tessera {
namespace {

// Larger tiles use up the digits that tell the samples of a pixel apart.
constexpr int kTileMax = 128;

// `value` of `digits` digits with its digits in reverse order.
uint64_t ReverseDigits(uint64_t value, uint64_t base, int digits) {
  uint64_t reversed = 0;
  for (int i = 0; i < digits; ++i, value /= base) reversed = reversed * base + value % base;
  return reversed;
}

// The number that is a multiple of `multiple` and leaves 1 when divided by `modulus`, which is coprime to it.
uint64_t UnitOf(uint64_t multiple, uint64_t modulus) {
  uint64_t value = 0;
  while (modulus > 1 && value % modulus != 1) value += multiple;
  return value;
}

}  // namespace

HaltonSampler HaltonSampler::Read(SamplerDirective& directive) {
  directive.ReadSampleCount(16);
  const Randomization randomization = directive.ReadRandomization(Randomization::kPermuteDigits);
  if (randomization == Randomization::kFastOwen) {
    directive.reader.FailAt(
        "randomization",
        "sampler \"halton\" has no randomization \"fastowen\": use \"owen\" or \"permutedigits\"");
  }
  return {directive.seed, randomization, directive.width, directive.height};
}

HaltonSampler::HaltonSampler(uint64_t seed, Randomization randomization, int width, int height)
    : seed_(seed), randomization_(randomization) {
  if (randomization == Randomization::kPermuteDigits)
    permutations_ = std::make_shared<const DigitPermutations>(seed);
  for (; columns_ < static_cast<uint64_t>(std::min(width, kTileMax)); columns_ *= 2) ++column_exponent_;
  for (; rows_ < static_cast<uint64_t>(std::min(height, kTileMax)); rows_ *= 3) ++row_exponent_;
  // The Chinese remainder theorem finds the index from its remainders by the two numbers.
  column_step_ = UnitOf(rows_, columns_);
  row_step_ = UnitOf(columns_, rows_);
}

void HaltonSampler::StartSample(int x, int y, uint32_t index) {
  const auto column = static_cast<uint64_t>(x % kTileMax), row = static_cast<uint64_t>(y % kTileMax);
  const uint64_t stride = columns_ * rows_;
  const uint64_t first = (ReverseDigits(column, 2, column_exponent_) * column_step_ +
                          ReverseDigits(row, 3, row_exponent_) * row_step_) %
                         stride;
  index_ = first + index * stride;
  pixel_ = Hash(seed_, static_cast<uint32_t>(x), static_cast<uint32_t>(y));
  dimension_ = 0;
}

float HaltonSampler::At(int dimension) const {
  if (dimension >= kHaltonDimensions) return UniformFloatFromHash(Hash(pixel_, index_, dimension));
  const HaltonBase& base = HaltonBases()[static_cast<size_t>(dimension)];
  // The digits that chose the pixel are the same in all of its samples; those after them are the place in it.
  if (dimension == 0) return RadicalInverse(base, index_ / columns_);
  if (dimension == 1) return RadicalInverse(base, index_ / rows_);
  switch (randomization_) {
    case Randomization::kNone: return RadicalInverse(base, index_);
    case Randomization::kPermuteDigits: return permutations_->RadicalInverse(dimension, index_);
    case Randomization::kFastOwen:
    case Randomization::kOwen: break;
  }
  return OwenRadicalInverse(base, index_, Hash(seed_, dimension));
}

}  // namespace tessera
