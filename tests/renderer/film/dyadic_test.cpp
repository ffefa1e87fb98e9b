// The tree of sample sums: the binary counter must give the node that a recursive definition gives.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "renderer/film/dyadic_sum.h"
#include "renderer/film/sample_range.h"

namespace tessera {
namespace {

float RecursiveSum(const std::vector<float>& samples, SampleRange range) {
  if (range.size == 1) return samples[range.begin];
  return RecursiveSum(samples, range.Left()) + RecursiveSum(samples, range.Right());
}

std::vector<float> RandomSamples(size_t count) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<float> exponent(-20, 20);
  std::vector<float> samples(count);
  for (float& sample : samples) sample = std::exp2(exponent(generator));
  return samples;
}

TEST(DyadicSum, IsTheNodeOfTheTreeToTheLastBit) {
  const std::vector<float> samples = RandomSamples(1 << 12);
  DyadicSum<float> sum;
  for (uint32_t size = 1; size <= samples.size(); size *= 2) {
    for (uint32_t begin = 0; begin < samples.size(); begin += std::max(size, 256u)) {
      const SampleRange range{begin, size};
      sum.Clear();
      for (uint32_t s = range.begin; s < range.end(); ++s) sum.Add(samples[s]);
      EXPECT_EQ(sum.Node(), RecursiveSum(samples, range)) << range.Text();
    }
  }
}

TEST(DyadicSum, DiffersFromTheRunningSum) {
  // Otherwise the test above could not tell one order from another.
  const std::vector<float> samples = RandomSamples(1 << 12);
  float running = 0;
  for (float sample : samples) running += sample;
  EXPECT_NE(running, RecursiveSum(samples, {0, 1 << 12}));
}

TEST(DyadicSumDeathTest, HasNoNodeForThreeSamples) {
  DyadicSum<float> sum;
  for (int i = 0; i < 3; ++i) sum.Add(1.0f);
  EXPECT_DEATH(sum.Node(), "depth_ == 1");
}

TEST(DyadicPartition, CoversEverySampleOnceWithItsLargestRanges) {
  for (uint32_t samples : {0u, 1u, 2u, 3u, 5u, 64u, 100u, 1000u, 65535u, kSamplesPerPixelMax}) {
    uint32_t end = 0;
    uint32_t previous_size = UINT32_MAX;
    for (SampleRange range : DyadicPartition(samples)) {
      EXPECT_TRUE(range.IsDyadic());
      EXPECT_EQ(range.begin, end);
      EXPECT_LT(range.size, previous_size);  // two of one size would be one of twice the size
      previous_size = range.size;
      end = range.end();
    }
    EXPECT_EQ(end, samples);
  }
}

TEST(SampleRange, FamilyRelationsHoldForEveryNodeOfASmallTree) {
  for (uint32_t size = 1; size <= 64; size *= 2) {
    for (uint32_t begin = 0; begin < 256; begin += size) {
      const SampleRange range{begin, size};
      EXPECT_TRUE(range.IsDyadic());
      EXPECT_TRUE(range.Parent().Contains(range));
      EXPECT_EQ(range.IsLeft() ? range.Parent().Left() : range.Parent().Right(), range);
      EXPECT_EQ(range.Sibling().Sibling(), range);
      EXPECT_EQ(range.Sibling().Parent(), range.Parent());
      EXPECT_FALSE(range.Overlaps(range.Sibling()));
    }
  }
}

TEST(SampleRange, RefusesWhatIsNoNode) {
  EXPECT_FALSE((SampleRange{0, 0}).IsDyadic());
  EXPECT_FALSE((SampleRange{0, 3}).IsDyadic());
  EXPECT_FALSE((SampleRange{1, 2}).IsDyadic());
  EXPECT_FALSE((SampleRange{0, kSamplesPerPixelMax * 2}).IsDyadic());
  EXPECT_FALSE((SampleRange{kSamplesPerPixelMax, 1}).IsDyadic());
  EXPECT_FALSE((SampleRange{0x80000000u, 0x80000000u}).IsDyadic());
}

}  // namespace
}  // namespace tessera
