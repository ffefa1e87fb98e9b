// The sampler "sobol": Sobol' points in as many dimensions as a path asks for, scrambled anew for every
// pixel.
#pragma once

#include "renderer/math/vec.h"
#include "renderer/sampler/pixel_seed.h"
#include "renderer/sampler/sampler_directive.h"
#include "renderer/sampler/sobol.h"

namespace tessera {

class SobolSampler {
 public:
  static constexpr bool kDependsOnCount = false;
  static SobolSampler Read(SamplerDirective& directive);

  SobolSampler(uint64_t seed, Randomization randomization)
      : seed_(seed), matrices_(&Matrices()), randomization_(randomization) {}

  void StartSample(int x, int y, uint32_t index) {
    seed_.SetPixel(x, y);
    index_ = index;
    dimension_ = 0;
  }
  float Get1D() { return At(dimension_++); }
  Point2 Get2D() {
    const float a = At(dimension_++);
    const float b = At(dimension_++);
    return {a, b};
  }

 private:
  float At(int dimension) const {
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

  PixelSeed seed_;
  const SobolMatrices* matrices_;
  Randomization randomization_;
  uint32_t index_ = 0;
  int dimension_ = 0;
};

}  // namespace tessera
