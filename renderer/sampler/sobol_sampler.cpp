#include "renderer/sampler/sobol_sampler.h"

namespace tessera {

SobolSampler SobolSampler::Read(SamplerDirective& directive) {
  directive.ReadSampleCount(16);
  return {directive.seed, directive.ReadRandomization()};
}

void SobolSampler::DrawBlock() {
  drawn_ = dimension_ + kLanes;
  if (randomization_ != Randomization::kFastOwen || drawn_ > kSobolDimensions) {
    for (unsigned i = 0; i < kLanes; ++i) values_[i] = At(static_cast<int>(dimension_ + i));
    return;
  }
  for (; seeded_ < drawn_; ++seeded_)
    seeds_[seeded_] = static_cast<uint32_t>(seed_.OfDimension(static_cast<int>(seeded_)));
  FastOwenSobolBlock(*matrices_, index_, static_cast<int>(dimension_) / kLanes, seeds_ + dimension_, values_);
}

float SobolSampler::At(int dimension) const {
  const uint64_t seed = seed_.OfDimension(dimension);
  uint32_t index = index_;
  int column = dimension;
  if (dimension >= kSobolDimensions) {
    // Beyond the table its dimensions are used again, with the samples in another order.
    column = dimension % kSobolDimensions;
    index = ShuffledIndex(index_, seed_.OfDimension(dimension / kSobolDimensions + (1 << 20)));
  }
  return RandomizedSobol(*matrices_, randomization_, index, column, static_cast<uint32_t>(seed));
}

}  // namespace tessera
