#include "renderer/sampler/sobol.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "renderer/sampler/padded_sobol_sampler.h"
#include "renderer/sampler/pixel_seed.h"
#include "renderer/sampler/sobol_sampler.h"
#include "renderer/sampler/zsobol_sampler.h"
#include "tests/renderer/sampler/net.h"

namespace tessera {
namespace {

// The first two dimensions of the sequence in the sample that was started.
Point2 FirstOfSequence(SobolSampler& sampler) {
  Point2 first{-1, -1};
  for (int d = 0; first.x < 0 || first.y < 0; ++d) {
    const float number = sampler.Get1D();
    if (SobolSampler::SequenceDimension(d) == 0) first.x = number;
    if (SobolSampler::SequenceDimension(d) == 1) first.y = number;
  }
  return first;
}

TEST(Sampler, SobolPrefixesOfPowersOfTwoAreNetsInEveryPixel) {
  for (Randomization randomization :
       {Randomization::kFastOwen, Randomization::kOwen, Randomization::kPermuteDigits}) {
    SobolSampler sobol(0, randomization);
    PaddedSobolSampler padded(0, randomization);
    for (int pixel = 0; pixel < 8; ++pixel) {
      for (uint32_t count : {1u, 2u, 16u, 64u, 256u}) {
        std::vector<Point2> of_sobol, of_padded;
        for (uint32_t i = 0; i < count; ++i) {
          sobol.StartSample(pixel, 3, i);
          of_sobol.push_back(FirstOfSequence(sobol));
          padded.StartSample(pixel, 3, i);
          of_padded.push_back(padded.Get2D());
        }
        ExpectNet(of_sobol);
        ExpectNet(of_padded);
      }
    }
  }
}

TEST(Sampler, RandomizedSobolIsTheRandomizationOfTheSobolPoint) {
  for (Randomization randomization : {Randomization::kNone, Randomization::kPermuteDigits,
                                      Randomization::kFastOwen, Randomization::kOwen}) {
    for (int dimension : {0, 1, 2, kSobolDimensions - 1}) {
      for (uint32_t index : {0u, 1u, 6u, 0x12345678u, 0xffffffffu}) {
        const uint32_t seed = static_cast<uint32_t>(Hash(index, dimension));
        EXPECT_EQ(RandomizedSobol(Matrices(), randomization, index, dimension, seed),
                  RandomizedFraction(randomization, SobolBits(Matrices(), index, dimension), seed));
      }
    }
  }
}

// Several dimensions are computed at a time; each must be the point of its own dimension and seed.
TEST(Sampler, SobolNumbersAreTheRandomizedPointsOfTheirDimensions) {
  for (const Randomization randomization : {Randomization::kNone, Randomization::kPermuteDigits,
                                            Randomization::kFastOwen, Randomization::kOwen}) {
    SobolSampler sampler(9, randomization);
    for (const uint32_t index : {0u, 1u, 77u, 0xffffffffu}) {
      for (const int x : {4, 5}) {
        PixelSeed seed(9);
        seed.SetPixel(x, 3);
        sampler.StartSample(x, 3, index);
        for (int d = 0; d < kSobolDimensions; ++d) {
          EXPECT_EQ(sampler.Get1D(),
                    RandomizedSobol(Matrices(), randomization, index, SobolSampler::SequenceDimension(d),
                                    static_cast<uint32_t>(seed.OfDimension(d))))
              << d;
        }
      }
    }
  }
}

TEST(Sampler, ZSobolSamplesOfAPixelAreStratifiedInEveryPairOfDimensions) {
  ZSobolSampler sampler(0, Randomization::kFastOwen, 6, 32, 32);
  for (int pixel = 0; pixel < 16; ++pixel) {
    std::vector<Point2> first, second;
    for (uint32_t i = 0; i < 64; ++i) {
      sampler.StartSample(pixel, 9, i);
      first.push_back(sampler.Get2D());
      second.push_back(sampler.Get2D());
    }
    ExpectNet(first);
    ExpectNet(second);
  }
}

TEST(Sampler, DimensionsBeyondTheTableStayStratified) {
  SobolSampler sampler(0, Randomization::kFastOwen);
  std::set<int> cells;
  for (uint32_t i = 0; i < 64; ++i) {
    sampler.StartSample(2, 2, i);
    for (int d = 0; d < 3 * kSobolDimensions; ++d) sampler.Get1D();
    cells.insert(static_cast<int>(sampler.Get1D() * 64));
  }
  EXPECT_EQ(cells.size(), 64u);
}

TEST(Sobol, FirstPointsAreThePublishedOnes) {
  const SobolMatrices& m = Matrices();
  // Joe and Kuo 2008, points 1 to 3 in dimensions 1 to 3, in natural (not Gray code) order.
  const float expected[3][3] = {{0.5f, 0.5f, 0.5f}, {0.25f, 0.75f, 0.75f}, {0.75f, 0.25f, 0.25f}};
  for (uint32_t i = 1; i <= 3; ++i) {
    for (int d = 0; d < 3; ++d)
      EXPECT_EQ(UniformFloat(SobolBits(m, i, d)), expected[i - 1][d]) << i << " " << d;
  }
}

TEST(Sobol, WideMatricesContinueTheNarrowOnes) {
  const SobolMatrices& m = Matrices();
  for (uint32_t i : {0u, 1u, 77u, 123456u, 0xffffffffu}) {
    for (int d = 0; d < 2; ++d) EXPECT_EQ(SobolBits(m, i, d), SobolBitsWide(m, i, d));
  }
  EXPECT_EQ(SobolBitsWide(m, uint64_t{1} << 40, 0), 0u);
  EXPECT_NE(SobolBitsWide(m, uint64_t{1} << 40, 1), 0u);
}

TEST(Sobol, PermutationElementsAreAPermutation) {
  for (uint32_t count : {1u, 2u, 7u, 64u, 1000u}) {
    std::set<uint32_t> seen;
    for (uint32_t i = 0; i < count; ++i) seen.insert(PermutationElement(i, count, 99));
    EXPECT_EQ(seen.size(), count);
    EXPECT_LT(*seen.rbegin(), count);
  }
}

}  // namespace
}  // namespace tessera
