// The sampler "zsobol": one two-dimensional Sobol' sequence along a Morton curve over all pixels (Ahmed and
// Wonka 2020). The errors of neighbouring pixels differ, which looks less noisy. The sequence depends on the
// number of samples.
#pragma once

#include "renderer/math/vec.h"
#include "renderer/sampler/sampler_directive.h"
#include "renderer/sampler/sobol.h"

namespace tessera {

class ZSobolSampler {
 public:
  static constexpr bool kDependsOnCount = true;
  static ZSobolSampler Read(SamplerDirective& directive);

  // For pictures of `width` x `height` pixels with 2^log2_samples samples each.
  ZSobolSampler(uint64_t seed, Randomization randomization, int log2_samples, int width, int height);

  void StartSample(int x, int y, uint32_t index);
  float Get1D();
  Point2 Get2D();

 private:
  uint64_t Index() const;
  float Fraction(uint64_t index, int column, uint32_t seed) const {
    return RandomizedFraction(randomization_, SobolBitsWide(*matrices_, index, column), seed);
  }

  uint64_t seed_;
  const SobolMatrices* matrices_;
  Randomization randomization_;
  int log2_samples_;
  int base4_digits_;           // of the Morton place
  uint64_t morton_place_ = 0;  // of the sample: its index is the lowest digits
  int dimension_ = 0;
};

}  // namespace tessera
