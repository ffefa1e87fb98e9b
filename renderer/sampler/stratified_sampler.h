// The sampler "stratified": jittered strata over the samples of a pixel. The sequence depends on the number
// of samples.
#pragma once

#include "renderer/math/vec.h"
#include "renderer/sampler/pixel_seed.h"
#include "renderer/sampler/sampler_directive.h"

namespace tessera {

class StratifiedSampler {
 public:
  static constexpr bool kDependsOnCount = true;
  static StratifiedSampler Read(SamplerDirective& directive);

  // `columns` x `rows` strata: as many as there are samples.
  StratifiedSampler(uint64_t seed, uint32_t columns, uint32_t rows, bool jitter)
      : seed_(seed), columns_(columns), rows_(rows), jitter_(jitter) {}

  void StartSample(int x, int y, uint32_t index) {
    seed_.SetPixel(x, y);
    index_ = index;
    dimension_ = 0;
  }
  float Get1D();
  Point2 Get2D();

 private:
  PixelSeed seed_;
  uint32_t columns_, rows_;
  bool jitter_;
  uint32_t index_ = 0;
  int dimension_ = 0;
};

}  // namespace tessera
