// The sampler "zsobol": one two-dimensional Sobol' sequence along a Morton curve over all pixels (Ahmed and
// Wonka 2020). The errors of neighbouring pixels differ, which looks less noisy. The sequence depends on the
// number of samples.
#pragma once

#include <array>
#include <cstddef>
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
  // Dimensions whose seeds are kept, and their points while the samples of a pixel are drawn.
  static constexpr int kKept = 64;

  struct Seeds {
    uint64_t digits = 0;            // of the permutations of digits
    uint64_t single = 0, pair = 0;  // of the randomisation by Get1D and Get2D
  };
  // Sobol' points of the first two dimensions.
  struct Points {
    uint32_t x = 0, y = 0;
  };

  Seeds MakeSeeds(int dimension) const;
  Seeds SeedsOf(int dimension) const {
    return dimension < kKept ? seeds_[static_cast<size_t>(dimension)] : MakeSeeds(dimension);
  }
  // The permuted digits end ... begin - 1 of the Morton place.
  uint64_t Permuted(int begin, int end, uint64_t seed) const;
  Points PointsOf(uint64_t index) const {
    return {SobolBitsWide(*matrices_, index, 0), SobolBitsWide(*matrices_, index, 1)};
  }
  // The points of the part of the index that all samples of the pixel share.
  Points PointsOfPixel(int dimension, uint64_t seed);
  // The points of the sample.
  Points PointsAt(int dimension, uint64_t seed);

  uint64_t seed_;
  const SobolMatrices* matrices_;
  Randomization randomization_;
  int log2_samples_;
  int base4_digits_;           // of the Morton place
  uint64_t morton_place_ = 0;  // of the sample: its index is the lowest digits
  int dimension_ = 0;
  std::array<Seeds, kKept> seeds_;
  // PointsOfPixel of each dimension whose bit is set in is_kept_.
  std::array<Points, kKept> kept_{};
  uint64_t is_kept_ = 0;
};

}  // namespace tessera
