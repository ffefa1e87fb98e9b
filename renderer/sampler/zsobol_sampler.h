// The sampler "zsobol": one two-dimensional Sobol' sequence along a Morton curve over all pixels (Ahmed and
// Wonka 2020). The errors of neighbouring pixels differ, which looks less noisy. The sequence depends on the
// number of samples.
#pragma once

#include <array>
#include <cstdint>

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
  // Dimensions whose digits of the pixel are kept while its samples are drawn.
  static constexpr int kKept = 64;

  uint64_t Index();
  // The permuted digits end ... begin - 1 of the Morton place.
  uint64_t Permuted(int begin, int end, uint64_t salt) const;
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
  // Of each dimension whose bit is set in is_kept_: the permuted digits that all samples of the pixel share.
  std::array<uint64_t, kKept> kept_{};
  uint64_t is_kept_ = 0;
};

}  // namespace tessera
