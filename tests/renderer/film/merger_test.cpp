// The frame depends on the set of results alone: any cut, order, copy or overlap gives the same bits.
#include "renderer/film/merger.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "renderer/film/dyadic_sum.h"
#include "renderer/util/hash.h"

namespace tessera {
namespace {

FrameSpec Spec(uint32_t samples, int tile_size) {
  FrameSpec spec;
  spec.width = 9;
  spec.height = 7;
  spec.crop = {1, 2, 9, 7};
  spec.samples_per_pixel = samples;
  spec.tile_size = tile_size;
  return spec;
}

// A stand-in for the renderer: a pure function of pixel, sample and channel, with values of very different
// size.
float SampleValue(int x, int y, uint32_t sample, int channel) {
  const uint64_t h = Hash(static_cast<uint64_t>(x), y, sample, channel);
  return UniformFloat(static_cast<uint32_t>(h)) * static_cast<float>(1u << ((h >> 32) % 20));
}

RadianceTile RenderUnit(const FrameSpec& spec, int tile, SampleRange range) {
  RadianceTile result{spec.TileBounds(tile), range, spec.Layout().shape(), {}};
  for (int y = result.bounds.y0; y < result.bounds.y1; ++y) {
    for (int x = result.bounds.x0; x < result.bounds.x1; ++x) {
      for (int c = 0; c < static_cast<int>(result.shape.sums); ++c) {
        DyadicSum<float> sum;
        for (uint32_t s = range.begin; s < range.end(); ++s) sum.Add(SampleValue(x, y, s, c));
        result.sums.push_back(sum.Node());
      }
    }
  }
  return result;
}

struct Unit {
  int tile;
  SampleRange range;
};

// Every unit of the frame in whole terms of the partition.
std::vector<Unit> WholeUnits(const FrameSpec& spec) {
  std::vector<Unit> units;
  for (int tile = 0; tile < spec.TileCount(); ++tile) {
    for (SampleRange range : DyadicPartition(spec.samples_per_pixel)) units.push_back({tile, range});
  }
  return units;
}

// A random cut of the units into smaller ones, some also left as they are, some twice; shuffled.
std::vector<Unit> RandomCut(const FrameSpec& spec, std::mt19937& generator) {
  std::vector<Unit> open = WholeUnits(spec), cut;
  while (!open.empty()) {
    const Unit unit = open.back();
    open.pop_back();
    const bool split = unit.range.size > 1 && generator() % 2 == 0;
    if (split) {
      open.push_back({unit.tile, unit.range.Left()});
      open.push_back({unit.tile, unit.range.Right()});
    }
    if (!split || generator() % 4 == 0) cut.push_back(unit);
    if (generator() % 5 == 0) cut.push_back(unit);
  }
  std::ranges::shuffle(cut, generator);
  return cut;
}

FramePicture Merge(const FrameSpec& spec, const std::vector<Unit>& units) {
  Merger merger(spec);
  for (const Unit& unit : units) {
    const bool had = merger.Has(unit.tile, unit.range);
    const auto outcome = merger.Add(unit.tile, RenderUnit(spec, unit.tile, unit.range));
    EXPECT_TRUE(outcome.has_value());
    EXPECT_EQ(*outcome, had ? Merger::Outcome::kDuplicate : Merger::Outcome::kMerged);
    EXPECT_TRUE(merger.Has(unit.tile, unit.range));
  }
  EXPECT_TRUE(merger.Complete());
  EXPECT_EQ(merger.node_count(), WholeUnits(spec).size());
  return merger.Picture();
}

TEST(Merger, AnyCutOrderAndCopiesGiveTheSameBits) {
  for (uint32_t samples : {1u, 2u, 13u, 16u, 100u}) {
    const FramePicture expected = Merge(Spec(samples, 4), WholeUnits(Spec(samples, 4)));
    std::mt19937 generator(samples);
    for (int round = 0; round < 20; ++round) {
      const FrameSpec spec = Spec(samples, round % 2 == 0 ? 4 : 3);
      const FramePicture picture = Merge(spec, RandomCut(spec, generator));
      ASSERT_EQ(picture.values, expected.values) << samples << " samples, round " << round;
      ASSERT_EQ(picture.samples_min, samples);
    }
  }
}

TEST(Merger, SumsThePartitionFromLeftToRight) {
  const FrameSpec spec = Spec(13, 8);
  const FramePicture picture = Merge(spec, WholeUnits(spec));
  float sums[4] = {0, 0, 0, 0};
  for (int c = 0; c < 4; ++c) {
    for (SampleRange range : DyadicPartition(13)) {
      DyadicSum<float> node;
      for (uint32_t s = range.begin; s < range.end(); ++s) node.Add(SampleValue(1, 2, s, c));
      sums[c] = range.begin == 0 ? node.Node() : sums[c] + node.Node();
    }
  }
  for (int c = 0; c < 3; ++c) EXPECT_EQ(picture.values[static_cast<size_t>(c)], sums[c] / sums[3]);
}

TEST(Merger, MissingIsWhatCompletesTheFrame) {
  std::mt19937 generator(3);
  for (int round = 0; round < 20; ++round) {
    const FrameSpec spec = Spec(100, 4);
    Merger merger(spec);
    std::vector<Unit> units = RandomCut(spec, generator);
    units.resize(units.size() / 3);
    for (const Unit& unit : units) {
      ASSERT_TRUE(merger.Add(unit.tile, RenderUnit(spec, unit.tile, unit.range)));
    }
    uint64_t missing = 0;
    for (int tile = 0; tile < spec.TileCount(); ++tile) {
      uint32_t end = 0;
      for (SampleRange range : merger.Missing(tile)) {
        EXPECT_GE(range.begin, end);
        end = range.end();
        EXPECT_FALSE(merger.Has(tile, range));
        missing += range.size * static_cast<uint64_t>(spec.TileBounds(tile).area());
        EXPECT_EQ(*merger.Add(tile, RenderUnit(spec, tile, range)), Merger::Outcome::kMerged);
      }
      EXPECT_TRUE(merger.Missing(tile).empty());
    }
    EXPECT_GT(missing, 0u);
    EXPECT_TRUE(merger.Complete());
    EXPECT_EQ(merger.Picture().values, Merge(spec, WholeUnits(spec)).values);
  }
}

TEST(Merger, APreviewShowsThePrefixAndBlackWhereNothingIs) {
  const FrameSpec spec = Spec(16, 4);
  Merger merger(spec);
  ASSERT_TRUE(merger.Add(0, RenderUnit(spec, 0, {0, 2})));
  ASSERT_TRUE(merger.Add(0, RenderUnit(spec, 0, {8, 2})));  // not next to the prefix: not shown
  const RadianceTile prefix = RenderUnit(spec, 0, {0, 2});
  const FramePicture picture = merger.Picture();
  EXPECT_EQ(picture.samples_min, 0u);
  EXPECT_EQ(picture.values[0], prefix.sums[0] / prefix.sums[3]);
  EXPECT_EQ(picture.values.back(), 0.0f);
  EXPECT_EQ(merger.samples_merged(), 4u * 16u);
}

TEST(Merger, RefusesWhatIsNotOfTheFrame) {
  const FrameSpec spec = Spec(12, 4);
  Merger merger(spec);
  const RadianceTile good = RenderUnit(spec, 0, {0, 4});
  EXPECT_FALSE(merger.Add(-1, good));
  EXPECT_FALSE(merger.Add(spec.TileCount(), good));
  EXPECT_FALSE(merger.Add(1, good));  // the bounds are those of tile 0
  RadianceTile bad = good;
  bad.range = {8, 8};  // beyond the 12 samples
  EXPECT_FALSE(merger.Add(0, bad));
  bad.range = {0, 16};
  EXPECT_FALSE(merger.Add(0, bad));
  bad.range = {1, 2};
  EXPECT_FALSE(merger.Add(0, bad));
  bad = good;
  bad.shape = {3};
  EXPECT_FALSE(merger.Add(0, bad));
  bad = good;
  bad.sums.pop_back();
  EXPECT_FALSE(merger.Add(0, bad));
  EXPECT_EQ(merger.samples_merged(), 0u);
}

TEST(Merger, RefusesANodeOfOtherChannelsByTheirNames) {
  const FrameSpec spec = Spec(1, 8);
  Merger merger(spec);
  TileNode node{0,
                {0, 1},
                RenderUnit(spec, 0, {0, 1}).sums,
                std::make_shared<const std::vector<Channel>>(ColorsAndWeight({"R", "G", "Z"}))};
  const auto refused = merger.Add(node);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("R G Z W, those of the frame R G B W"));
  node.channels = std::make_shared<const std::vector<Channel>>(spec.channels);
  EXPECT_TRUE(merger.Add(node));
}

TEST(Merger, APixelOfNoWeightIsBlack) {
  const FrameSpec spec = Spec(1, 8);
  Merger merger(spec);
  RadianceTile tile = RenderUnit(spec, 0, {0, 1});
  tile.sums[3] = 0;
  ASSERT_TRUE(merger.Add(0, tile));
  EXPECT_EQ(merger.Picture().values[0], 0.0f);
}

}  // namespace
}  // namespace tessera
