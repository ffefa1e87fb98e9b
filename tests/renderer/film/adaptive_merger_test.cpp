// Adaptive frames are a function of the set of their units, too: which pixels stop, where, and every bit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/renderer/film/adaptive_frames.h"

namespace tessera {
namespace {

constexpr double kThreshold = 0.05;  // some tiles stop at once, some later, some never

std::vector<TileGoal> Goals(const Merger& merger) {
  std::vector<TileGoal> goals;
  for (int tile = 0; tile < merger.spec().TileCount(); ++tile) goals.push_back(merger.Goal(tile));
  return goals;
}

void ExpectEqual(const Merger& a, const Merger& b) {
  EXPECT_EQ(Goals(a), Goals(b));
  EXPECT_EQ(a.samples_merged(), b.samples_merged());
  EXPECT_EQ(a.samples_total(), b.samples_total());
  EXPECT_EQ(a.Complete(), b.Complete());
  EXPECT_EQ(a.node_count(), b.node_count());
  EXPECT_EQ(a.Picture().values, b.Picture().values);
}

TEST(AdaptiveMerger, TilesStopEachWhereItsNoiseAllows) {
  const Merger merger = MergeWhatIsWanted(AdaptiveSpec(256, kThreshold));
  EXPECT_TRUE(merger.Complete());
  std::set<uint32_t> stops;
  for (const TileGoal& goal : Goals(merger)) {
    EXPECT_TRUE(goal.is_final);
    stops.insert(goal.samples);
  }
  EXPECT_GE(stops.size(), 3u);
  EXPECT_EQ(*stops.begin(), kDecisionSamplesMin);
  EXPECT_EQ(*stops.rbegin(), 256u);
  EXPECT_EQ(merger.Picture().samples_min, kDecisionSamplesMin);
}

TEST(AdaptiveMerger, PixelsOfATileStopEachWhereItsNoiseAllows) {
  const FrameSpec spec = AdaptiveSpec(256, kThreshold);
  const Merger merger = MergeWhatIsWanted(spec);
  const FramePicture picture = merger.Picture();
  const std::vector<float> counts = picture.Channel(kSamplesChannel);
  uint64_t sum = 0;
  for (const float samples : counts) sum += static_cast<uint64_t>(samples);
  EXPECT_EQ(merger.samples_merged(), sum);
  EXPECT_EQ(merger.samples_total(), sum);
  int mixed = 0;  // rows of tiles
  for (int y = 0; y < spec.crop.height(); ++y) {
    for (int x = 0; x + 7 < spec.crop.width(); x += 8) {
      const float* row = &counts[static_cast<size_t>(y * spec.crop.width() + x)];
      mixed += row[0] < row[7];
      EXPECT_LE(row[0], row[7]) << "the right is the noisier: row " << y << ", tile at " << x;
    }
  }
  EXPECT_GT(mixed, 10);
}

// Even if the units beyond a stop are there before it is known.
TEST(AdaptiveMerger, AnyCutOrderAndCopiesGiveTheSameStopsAndBits) {
  for (const uint32_t samples : {1u, 16u, 17u, 48u, 100u, 128u}) {
    const FrameSpec spec = AdaptiveSpec(samples, kThreshold);
    const Merger expected = MergeWhatIsWanted(spec);
    std::mt19937 generator(samples);
    for (int round = 0; round < 10; ++round) {
      Merger merger(spec);
      for (const TileUnit& unit : RandomUnits(spec, generator)) {
        const bool had = merger.Has(unit.tile, unit.range);
        const auto outcome = merger.Add(unit.tile, RenderNoise(spec, unit.tile, unit.range));
        ASSERT_TRUE(outcome.has_value());
        ASSERT_EQ(*outcome, had ? Merger::Outcome::kDuplicate : Merger::Outcome::kMerged);
        ASSERT_TRUE(merger.Has(unit.tile, unit.range));
      }
      ASSERT_TRUE(merger.Complete()) << samples << " samples, round " << round;
      ExpectEqual(merger, expected);
    }
  }
}

TEST(AdaptiveMerger, AStoppedPixelIsThatOfAFrameOfAsManySamples) {
  const FramePicture picture = MergeWhatIsWanted(AdaptiveSpec(256, kThreshold)).Picture();
  const std::vector<float> stops = picture.Channel(kSamplesChannel);
  const std::set<float> counts(stops.begin(), stops.end());
  EXPECT_GE(counts.size(), 3u);
  for (const float count : counts) {
    const auto samples = static_cast<uint32_t>(count);
    const FramePicture uniform = MergeWhatIsWanted(AdaptiveSpec(samples, 0)).Picture();
    const std::vector<float> stopped = picture.Channel("R"), whole = uniform.Channel("R");
    for (size_t pixel = 0; pixel < stops.size(); ++pixel) {
      if (stops[pixel] == count) {
        EXPECT_EQ(stopped[pixel], whole[pixel]);
      }
    }
  }
}

TEST(AdaptiveMerger, WithoutThresholdEveryPixelGetsAllSamples) {
  const Merger merger = MergeWhatIsWanted(AdaptiveSpec(100, 0));
  EXPECT_TRUE(merger.Complete());
  EXPECT_EQ(merger.samples_merged(), 100u * 23 * 15);
  EXPECT_THAT(merger.Picture().Channel(kSamplesChannel), testing::Each(100.0f));
  EXPECT_EQ(merger.node_count(), 6u * DyadicPartition(100).size());
}

TEST(AdaptiveMerger, TheTotalShrinksAsTilesStop) {
  const FrameSpec spec = AdaptiveSpec(128, 1);  // all stop at the first decision
  Merger merger(spec);
  EXPECT_EQ(merger.samples_total(), 128u * 23 * 15);
  for (int tile = 0; tile < spec.TileCount(); ++tile) {
    EXPECT_FALSE(merger.Complete());
    for (const SampleRange range : merger.Missing(tile))
      ASSERT_TRUE(merger.Add(tile, RenderNoise(spec, tile, range)));
    EXPECT_EQ(merger.Goal(tile), (TileGoal{kDecisionSamplesMin, true, {}}));
  }
  EXPECT_TRUE(merger.Complete());
  EXPECT_EQ(merger.samples_total(), kDecisionSamplesMin * 23u * 15u);
}

TEST(AdaptiveMerger, SamplesBeyondAStopAreDroppedAndRefusedAsNotWanted) {
  const FrameSpec spec = AdaptiveSpec(128, 1);
  Merger merger(spec);
  const SampleRange early{kDecisionSamplesMin * 2, kDecisionSamplesMin * 2};
  EXPECT_EQ(*merger.Add(0, RenderNoise(spec, 0, early)), Merger::Outcome::kMerged);
  for (const SampleRange range : merger.Missing(0))
    ASSERT_EQ(*merger.Add(0, RenderNoise(spec, 0, range)), Merger::Outcome::kMerged);
  EXPECT_EQ(merger.samples_merged(), kDecisionSamplesMin * 64u);
  EXPECT_EQ(*merger.Add(0, RenderNoise(spec, 0, early)), Merger::Outcome::kDuplicate);
  EXPECT_TRUE(merger.Has(0, early));
  EXPECT_TRUE(merger.Missing(0).empty());
}

// What another merger kept is enough to go on from, in whatever order it comes, with or without the units
// that it was made of.
TEST(AdaptiveMerger, GoesOnFromTheNodesOfAnother) {
  for (const uint32_t samples : {100u, 128u, 256u}) {
    const FrameSpec spec = AdaptiveSpec(samples, kThreshold);
    const Merger expected = MergeWhatIsWanted(spec);
    const FramePicture picture = expected.Picture();
    const auto render = [&](const TileUnit& unit) {
      const PixelMask wanted = WantedPixels(spec, picture, unit.tile, unit.range);
      return RenderNoise(spec, unit.tile, unit.range, wanted);
    };
    std::mt19937 generator(samples);
    for (int round = 0; round < 40; ++round) {
      std::vector<TileUnit> units = RandomUnits(spec, generator);
      units.resize(generator() % units.size());
      Merger before(spec), after(spec);
      for (const TileUnit& unit : units) ASSERT_TRUE(before.Add(unit.tile, render(unit)));
      std::vector<TileNode> kept = before.AllNodes();
      for (const TileUnit& unit : units) {
        if (generator() % 2 == 0) continue;
        const auto tile = static_cast<uint32_t>(unit.tile);
        kept.push_back({tile, unit.range, render(unit).sums});
      }
      std::ranges::shuffle(kept, generator);
      for (TileNode& node : kept) ASSERT_TRUE(after.Add(std::move(node)));
      ExpectEqual(after, before);
      for (int tile = 0; tile < spec.TileCount(); ++tile) {
        EXPECT_EQ(after.Missing(tile), before.Missing(tile));
        RenderWhatIsWanted(after, tile);
      }
      ExpectEqual(after, expected);
    }
  }
}

// A preview of samples that lie apart shows the prefix alone, and says of how many samples.
TEST(AdaptiveMerger, APreviewSaysHowManySamplesItShows) {
  const FrameSpec spec = AdaptiveSpec(128, 0.001);
  Merger merger(spec);
  for (const SampleRange range : {SampleRange{0, 8}, {8, 8}, {16, 4}, {24, 8}})
    ASSERT_TRUE(merger.Add(0, RenderNoise(spec, 0, range)));
  const FramePicture picture = merger.Picture();
  EXPECT_EQ(picture.Channel(kSamplesChannel).front(), 20.0f);
  EXPECT_EQ(picture.Channel(kSamplesChannel).back(), 0.0f);
  EXPECT_EQ(picture.values.back(), 0.0f);
}

}  // namespace
}  // namespace tessera
