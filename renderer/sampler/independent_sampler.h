// The sampler "independent": hashes, without structure between samples.
#pragma once

#include "renderer/math/random_stream.h"
#include "renderer/math/vec.h"
#include "renderer/sampler/pixel_seed.h"
#include "renderer/sampler/sampler_directive.h"

namespace tessera {

class IndependentSampler {
 public:
  static constexpr bool kDependsOnCount = false;
  static IndependentSampler Read(SamplerDirective& directive);

  explicit IndependentSampler(uint64_t seed = 0) : seed_(seed) {}

  void StartSample(int x, int y, uint32_t index) {
    seed_.SetPixel(x, y);
    stream_ = RandomStream(Hash(seed_.value(), index));
  }
  float Get1D() { return stream_.Next(); }
  Point2 Get2D() { return stream_.Next2(); }

 private:
  PixelSeed seed_;
  RandomStream stream_;
};

}  // namespace tessera
