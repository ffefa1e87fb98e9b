#include "renderer/sampler/halton.h"

#include <gtest/gtest.h>

#include <set>

#include "renderer/sampler/halton_sampler.h"

namespace tessera {
namespace {

TEST(Halton, RadicalInversesAreTheDigitsReversed) {
  const auto& bases = HaltonBases();
  EXPECT_EQ(bases[0].base, 2u);
  EXPECT_EQ(bases[3].base, 7u);
  EXPECT_EQ(bases[kHaltonDimensions - 1].base, 719u);
  EXPECT_FLOAT_EQ(RadicalInverse(bases[0], 6), 3.0f / 8);             // 110 -> 0.011
  EXPECT_FLOAT_EQ(RadicalInverse(bases[1], 5), 2.0f / 3 + 1.0f / 9);  // 12 -> 0.21
  EXPECT_FLOAT_EQ(RadicalInverse(bases[127], 720), 1.0f / 719 + 1.0f / (719 * 719));
}

TEST(Halton, PermutedDigitsAreAPermutationOfTheRadicalInverses) {
  const DigitPermutations permutations(5);
  for (const int dimension : {0, 1, 2, 5, 20}) {
    const HaltonBase& base = HaltonBases()[static_cast<size_t>(dimension)];
    // The first base^2 points have every pair of leading digits once, in another order than unpermuted.
    const uint32_t cells = base.base * base.base;
    std::set<uint32_t> seen;
    int moved = 0;
    for (uint32_t i = 0; i < cells; ++i) {
      const auto cell = [&](float u) { return static_cast<uint32_t>(static_cast<double>(u) * cells); };
      seen.insert(cell(permutations.RadicalInverse(dimension, i)));
      moved += cell(permutations.RadicalInverse(dimension, i)) != cell(RadicalInverse(base, i));
    }
    EXPECT_EQ(seen.size(), cells) << base.base;
    EXPECT_TRUE(moved > 0 || base.base <= 3) << base.base;
  }
}

TEST(HaltonSampler, DimensionsBeyondTheTableAreIndependentOfEachOther) {
  HaltonSampler sampler(0, Randomization::kPermuteDigits, 32, 32);
  double sum = 0, product = 0;
  constexpr int kCount = 4000;
  for (uint32_t i = 0; i < kCount; ++i) {
    sampler.StartSample(2, 2, i);
    for (int d = 0; d < kHaltonDimensions; ++d) sampler.Get1D();
    const float a = sampler.Get1D();
    const float b = sampler.Get1D();
    sum += a;
    product += (a - 0.5) * (b - 0.5);
  }
  EXPECT_NEAR(sum / kCount, 0.5, 0.02);
  EXPECT_NEAR(product / kCount, 0, 0.01);
}

}  // namespace
}  // namespace tessera
