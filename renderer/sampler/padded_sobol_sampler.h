// The sampler "paddedsobol": two-dimensional Sobol' points, shuffled and scrambled anew for every pixel and
// pair of dimensions.
#pragma once

#include "renderer/math/vec.h"
#include "renderer/sampler/pixel_seed.h"
#include "renderer/sampler/sampler_directive.h"
#include "renderer/sampler/sobol.h"

namespace tessera {

class PaddedSobolSampler {
 public:
  static constexpr bool kDependsOnCount = false;
  static PaddedSobolSampler Read(SamplerDirective& directive);

  PaddedSobolSampler(uint64_t seed, Randomization randomization)
      : seed_(seed), matrices_(&Matrices()), randomization_(randomization) {}

  void StartSample(int x, int y, uint32_t index) {
    seed_.SetPixel(x, y);
    index_ = index;
    dimension_ = 0;
  }
  float Get1D() {
    const uint64_t seed = seed_.OfDimension(dimension_++);
    return Fraction(ShuffledIndex(index_, seed), 0, static_cast<uint32_t>(seed));
  }
  Point2 Get2D() {
    const uint64_t seed = seed_.OfDimension(dimension_);
    dimension_ += 2;
    const uint32_t index = ShuffledIndex(index_, seed);
    return {Fraction(index, 0, static_cast<uint32_t>(seed)),
            Fraction(index, 1, static_cast<uint32_t>(MixBits(seed)))};
  }

 private:
  float Fraction(uint32_t index, int column, uint32_t seed) const {
    return RandomizedSobol(*matrices_, randomization_, index, column, seed);
  }

  PixelSeed seed_;
  const SobolMatrices* matrices_;
  Randomization randomization_;
  uint32_t index_ = 0;
  int dimension_ = 0;
};

}  // namespace tessera
