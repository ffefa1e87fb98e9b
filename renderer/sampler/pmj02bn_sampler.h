// The sampler "pmj02bn": (0,2)-sequences, which are progressive multi-jittered (Christensen, Kensler,
// Kilpatrick 2018), the same for all pixels of a tile and moved in each by blue noise.
//
// The sequences are Sobol's first two dimensions under Owen's scrambling, which is the same as drawing pmj02
// points at random (Helmer, Christensen, Kensler 2021), but gives any point by its index.
#pragma once

#include "renderer/math/vec.h"
#include "renderer/sampler/blue_noise.h"
#include "renderer/sampler/sampler_directive.h"
#include "renderer/sampler/sobol.h"

namespace tessera {

class Pmj02bnSampler {
 public:
  static constexpr bool kDependsOnCount = false;
  static Pmj02bnSampler Read(SamplerDirective& directive);

  explicit Pmj02bnSampler(uint64_t seed) : seed_(seed), matrices_(&Matrices()), noise_(&BlueNoise::Get()) {}

  void StartSample(int x, int y, uint32_t index);
  float Get1D() {
    const uint64_t seed = SeedOf(dimension_);
    const float u = Fraction(ShuffledIndex(index_, seed), 0, static_cast<uint32_t>(seed));
    return Moved(u, Shift(dimension_++));
  }
  Point2 Get2D() {
    const uint64_t seed = SeedOf(dimension_);
    const uint32_t index = ShuffledIndex(index_, seed);
    const float x = Fraction(index, 0, static_cast<uint32_t>(seed));
    const float y = Fraction(index, 1, static_cast<uint32_t>(MixBits(seed)));
    const float shift_x = Shift(dimension_++);
    const float shift_y = Shift(dimension_++);
    return {Moved(x, shift_x), Moved(y, shift_y)};
  }

  // How far the points of the pixel are moved in a dimension, in [0, 1).
  float Shift(int dimension) const {
    const uint64_t hash = Hash(seed_, dimension);  // no two dimensions see the mask at the same place
    return noise_->At(x_ + static_cast<int>(hash % kBlueNoiseSide),
                      y_ + static_cast<int>((hash >> 32) % kBlueNoiseSide));
  }

 private:
  uint64_t SeedOf(int dimension) const {
    return MixBits(tile_ ^ (static_cast<uint64_t>(dimension) + 1) * 0x9e3779b97f4a7c15u);
  }
  float Fraction(uint32_t index, int column, uint32_t seed) const {
    return RandomizedSobol(*matrices_, Randomization::kFastOwen, index, column, seed);
  }
  static float Moved(float u, float shift) {
    const float sum = u + shift;
    const float moved = sum < 1 ? sum : sum - 1;
    return moved < kOneMinusEpsilon ? moved : kOneMinusEpsilon;
  }

  uint64_t seed_;
  const SobolMatrices* matrices_;
  const BlueNoise* noise_;
  uint64_t tile_ = 0;  // hash of the tile, of the size of the mask: beyond it the points differ
  int x_ = 0, y_ = 0;
  uint32_t index_ = 0;
  int dimension_ = 0;
};

}  // namespace tessera
