#include "coordinator/core/schedule/sample_set.h"

#include <gtest/gtest.h>

#include <set>

#include "renderer/util/hash.h"

namespace tessera {
namespace {

// The same as a set of numbers, slowly.
std::set<uint32_t> Samples(const SampleSet& set) {
  std::set<uint32_t> samples;
  for (const auto& [begin, end] : set.intervals()) {
    for (uint32_t s = begin; s < end; ++s) samples.insert(s);
  }
  return samples;
}

TEST(SampleSet, AgreesWithASetOfNumbers) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    SampleSet set;
    std::set<uint32_t> wanted;
    for (uint64_t step = 0; step < 40; ++step) {
      const uint64_t draw = Hash(seed, step);
      const uint32_t size = 1u << (draw % 6);
      const uint32_t begin = static_cast<uint32_t>(draw >> 8) % (128 / size) * size;
      const SampleRange range{begin, size};
      const bool adds = (draw >> 40 & 1) != 0;
      for (uint32_t s = range.begin; s < range.end(); ++s)
        adds ? (void)wanted.insert(s) : (void)wanted.erase(s);
      adds ? set.Add(range) : set.Remove(range);
      ASSERT_EQ(Samples(set), wanted);
      ASSERT_EQ(set.Count(), wanted.size());
      const SampleRange probe{static_cast<uint32_t>(draw >> 50) % 32 * 4, 4};
      size_t inside = 0;
      for (uint32_t s = probe.begin; s < probe.end(); ++s) inside += wanted.count(s);
      ASSERT_EQ(set.Contains(probe), inside == 4);
      ASSERT_EQ(set.Overlaps(probe), inside > 0);
      for (size_t i = 1; i < set.intervals().size(); ++i) {
        ASSERT_LT(set.intervals()[i - 1].end, set.intervals()[i].begin) << "touching intervals must be one";
      }
    }
  }
}

TEST(SampleSet, LargestDyadicRangeIsAlignedAndFits) {
  EXPECT_EQ(DyadicSizeMax(0, 1), 1u);
  EXPECT_EQ(DyadicSizeMax(0, 100), 64u);
  EXPECT_EQ(DyadicSizeMax(64, 100), 32u);
  EXPECT_EQ(DyadicSizeMax(96, 100), 4u);
  EXPECT_EQ(DyadicSizeMax(1, 100), 1u);
  EXPECT_EQ(DyadicSizeMax(6, 100), 2u);
  EXPECT_EQ(DyadicSizeMax(0, kSamplesPerPixelMax), kSamplesPerPixelMax);
}

}  // namespace
}  // namespace tessera
