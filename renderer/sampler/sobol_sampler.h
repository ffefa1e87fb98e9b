// The sampler "sobol": Sobol' points in as many dimensions as a path asks for, scrambled anew for every
// pixel. Dimensions are computed several at a time.
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

  SobolSampler(uint64_t seed, Randomization randomization);

  // The dimension of the sequence that a dimension of samples is, which is not negative.
  static int SequenceDimension(int dimension);

  void StartSample(int x, int y, uint32_t index) {
    if (seed_.SetPixel(x, y)) seeded_ = 0;
    index_ = index;
    dimension_ = 0;
    drawn_ = 0;
  }
  float Get1D() {
    if (dimension_ == drawn_) DrawBlock();
    return values_[dimension_++ % kLanes];
  }
  Point2 Get2D() {
    const float a = Get1D();
    const float b = Get1D();
    return {a, b};
  }

 private:
  static constexpr int kLanes = SobolMatrices::kLanes;

  // Computes values_ from dimension_ on, which is a multiple of kLanes.
  void DrawBlock();
  float At(int dimension) const;

  PixelSeed seed_;
  const SobolMatrices* matrices_;
  const SobolMatrices::Block* first_blocks_;  // of the dimensions whose order differs from the sequence's
  Randomization randomization_;
  uint32_t index_ = 0;
  unsigned dimension_ = 0;
  unsigned drawn_ = 0;   // the dimension after those of values_
  unsigned seeded_ = 0;  // the dimensions of this pixel that have seeds_
  alignas(32) float values_[kLanes] = {};
  alignas(32) uint32_t seeds_[kSobolDimensions];
};

}  // namespace tessera
