// The sampler "halton": one Halton sequence over the pixels of a tile. The first two dimensions of a point
// choose its pixel, so that those of a pixel are every n-th of the sequence.
#pragma once

#include <memory>

#include "renderer/math/vec.h"
#include "renderer/sampler/halton.h"
#include "renderer/sampler/sampler_directive.h"

namespace tessera {

class HaltonSampler {
 public:
  static constexpr bool kDependsOnCount = false;
  static HaltonSampler Read(SamplerDirective& directive);

  // For a picture of width x height pixels. kFastOwen counts as kOwen.
  HaltonSampler(uint64_t seed, Randomization randomization, int width, int height);

  void StartSample(int x, int y, uint32_t index);
  float Get1D() { return At(dimension_++); }
  Point2 Get2D() {
    const float a = At(dimension_++);
    const float b = At(dimension_++);
    return {a, b};
  }

 private:
  float At(int dimension) const;

  uint64_t seed_;
  Randomization randomization_;
  std::shared_ptr<const DigitPermutations> permutations_;  // of kPermuteDigits; copies share it
  // The tile has 2^exponent x power columns and rows, powers of the first two bases.
  int column_exponent_ = 0, row_exponent_ = 0;
  uint64_t columns_ = 1, rows_ = 1;
  uint64_t column_step_ = 0, row_step_ = 0;  // added to the index for the next place in the sequence

  uint64_t pixel_ = 0;  // hash of the pixel, for dimensions beyond the table
  uint64_t index_ = 0;  // in the sequence
  int dimension_ = 0;
};

}  // namespace tessera
