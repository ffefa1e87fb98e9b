#include "coordinator/core/schedule/frame_work.h"

#include <gtest/gtest.h>

#include <map>

#include "coordinator/core/schedule/policy.h"

namespace tessera {
namespace {

constexpr double kPlenty = 1e9;
const auto kAnyTile = [](uint32_t) { return true; };

// Four tiles of 8 x 8 pixels.
FrameSpec Frame(uint32_t samples) {
  FrameSpec spec;
  spec.width = spec.height = 16;
  spec.crop = {0, 0, 16, 16};
  spec.tile_size = 8;
  spec.samples_per_pixel = samples;
  return spec;
}

TEST(FrameWork, BeginsWithOneSampleWhileNothingIsMeasured) {
  FrameWork work(Frame(64));
  for (uint32_t tile = 0; tile < 4; ++tile) {
    EXPECT_EQ(work.Take(kPlenty, kAnyTile), (TileSamples{tile, {0, 1}}));
  }
  EXPECT_FALSE(work.Cost({0, {0, 1}}));
  EXPECT_FALSE(work.OpenCost());
}

TEST(FrameWork, CompletesTheImageInDoublings) {
  FrameWork work(Frame(8));
  std::vector<SampleRange> of_tile_2;
  std::map<uint32_t, uint32_t> reached;
  while (const auto samples = work.Take(kPlenty, kAnyTile)) {
    if (samples->tile == 2) of_tile_2.push_back(samples->range);
    // No tile is two doublings ahead of another.
    reached[samples->tile] = samples->range.end();
    uint32_t least = reached.size() < 4 ? 0 : 8;
    for (const auto& [tile, end] : reached) least = std::min(least, end);
    EXPECT_LE(samples->range.end(), std::max(1u, least * 2));
    work.Finish(*samples);
    work.RecordCost(*samples,
                    samples->range.size * 10.0);  // so costly that the first pass stays at one sample
  }
  EXPECT_EQ(of_tile_2, (std::vector<SampleRange>{{0, 1}, {1, 1}, {2, 2}, {4, 4}}));
  EXPECT_TRUE(work.Complete());
}

TEST(FrameWork, TilesThatGoFirstGetAllSamplesBeforeOthersGetAny) {
  // Pixels of tiles 1 and 3.
  FrameWork work(Frame(8), 0, {9, 7, 10, 9});
  std::vector<uint32_t> tiles;
  while (const auto samples = work.Take(kPlenty, kAnyTile)) {
    tiles.push_back(samples->tile);
    work.Finish(*samples);
    work.RecordCost(*samples, samples->range.size * 10.0);
  }
  EXPECT_EQ(tiles, (std::vector<uint32_t>{1, 3, 1, 3, 1, 3, 1, 3, 0, 2, 0, 2, 0, 2, 0, 2}));
  EXPECT_TRUE(work.Complete());
}

TEST(FrameWork, SamplesOfATileThatGoesFirstAreNextWhenTheyAreGivenBack) {
  FrameWork work(Frame(1), 0, {9, 9, 10, 10});
  const auto first = work.Take(kPlenty, kAnyTile);
  EXPECT_EQ(first->tile, 3u);
  EXPECT_EQ(work.Take(kPlenty, kAnyTile)->tile, 0u);
  work.GiveBack(*first, {});
  EXPECT_EQ(work.Take(kPlenty, kAnyTile), first);
}

TEST(FrameWork, TheFirstPassIsShortAndLaterUnitsAreAsLongAsRequested) {
  FrameWork work(Frame(1024));
  const auto first = work.Take(kPlenty, kAnyTile);
  work.Finish(*first);
  work.RecordCost(*first, kFirstPassDuration_s / 8);
  EXPECT_EQ(work.Take(kPlenty, kAnyTile), (TileSamples{1, {0, 8}}));
  // Tile 0 goes on at 1: alignment allows one, then two, four, ...
  for (uint32_t tile = 2; tile < 4; ++tile) EXPECT_EQ(work.Take(kPlenty, kAnyTile)->tile, tile);
  EXPECT_EQ(work.Take(kPlenty, kAnyTile), (TileSamples{0, {1, 1}}));
  EXPECT_EQ(work.Take(kPlenty, kAnyTile), (TileSamples{0, {2, 2}}));
  EXPECT_EQ(work.Take(kPlenty, kAnyTile), (TileSamples{0, {4, 4}}));
  // From 8 on, twice the first pass was asked: [8,16), and then 16 at a time.
  for (int tile = 0; tile < 4; ++tile)
    EXPECT_EQ(work.Take(kFirstPassDuration_s * 2, kAnyTile)->range, (SampleRange{8, 8}));
  for (int tile = 0; tile < 4; ++tile)
    EXPECT_EQ(work.Take(kFirstPassDuration_s * 2, kAnyTile)->range, (SampleRange{16, 16}));
  EXPECT_EQ(work.Take(kFirstPassDuration_s * 2, kAnyTile)->range, (SampleRange{32, 16}));
}

TEST(FrameWork, TilesAreSizedByTheirOwnCost) {
  FrameWork work(Frame(1024));
  for (uint32_t tile = 0; tile < 4; ++tile) {
    const TileSamples samples{tile, {0, 1}};
    work.Finish(samples);
    work.RecordCost(samples, tile == 3 ? 1.0 : 0.001);
  }
  EXPECT_DOUBLE_EQ(*work.Cost({3, {0, 4}}), 4.0);
  EXPECT_DOUBLE_EQ(*work.Cost({1, {0, 4}}), 0.004);
  EXPECT_NEAR(*work.OpenCost(), 1023 * 1.003, 1e-6);
}

TEST(FrameWork, UnmeasuredTilesCostTheAverage) {
  FrameWork work(Frame(2));
  const auto samples = work.Take(kPlenty, kAnyTile);
  work.RecordCost(*samples, 0.5);
  EXPECT_DOUBLE_EQ(*work.Cost({2, {0, 2}}), 1.0);
  EXPECT_FALSE(work.IsMeasured(2));
  EXPECT_NEAR(*work.OpenCost(), 7 * 0.5, 1e-9);
}

TEST(FrameWork, ReturnedSamplesAreOpenUnlessDoneOrHeld) {
  FrameWork work(Frame(16));
  const TileSamples all{0, {0, 16}};
  ASSERT_TRUE(work.TakeExactly(all));
  EXPECT_FALSE(work.TakeExactly({0, {8, 8}}));
  work.Finish({0, {0, 4}});
  const SampleRange held[] = {{8, 4}};
  work.GiveBack(all, held);
  EXPECT_FALSE(work.TakeExactly({0, {0, 4}}));
  EXPECT_FALSE(work.TakeExactly({0, {8, 4}}));
  EXPECT_TRUE(work.TakeExactly({0, {4, 4}}));
  EXPECT_TRUE(work.TakeExactly({0, {12, 4}}));
}

TEST(FrameWork, FinishingCountsEachSampleOnce) {
  FrameWork work(Frame(16));
  EXPECT_TRUE(work.Finish({0, {4, 4}}));
  EXPECT_FALSE(work.Finish({0, {4, 4}}));
  EXPECT_FALSE(work.Finish({0, {4, 2}}));
  EXPECT_TRUE(work.Finish({0, {0, 8}}));  // half of it is new
  EXPECT_FALSE(work.TakeExactly({0, {0, 1}})) << "what is done is not open";
  EXPECT_TRUE(work.Finish({0, {8, 8}}));
  for (uint32_t tile = 1; tile < 4; ++tile) {
    EXPECT_FALSE(work.Complete());
    EXPECT_TRUE(work.Finish({tile, {0, 16}}));
  }
  EXPECT_TRUE(work.Complete());
}

TEST(FrameWork, TakesOnlyTilesThatAreAllowed) {
  FrameWork work(Frame(1));
  const auto only_last = [](uint32_t tile) { return tile == 3; };
  EXPECT_TRUE(work.HasOpen(only_last));
  EXPECT_EQ(work.Take(kPlenty, only_last), (TileSamples{3, {0, 1}}));
  EXPECT_FALSE(work.Take(kPlenty, only_last));
  EXPECT_FALSE(work.HasOpen(only_last));
  EXPECT_TRUE(work.HasOpen());
}

constexpr uint32_t kFirst = kDecisionSamplesMin;

FrameSpec AdaptiveFrame(uint32_t samples) {
  FrameSpec spec = Frame(samples);
  spec.SetNoiseThreshold(0.1);
  return spec;
}

// Takes and finishes all that is open.
std::vector<TileSamples> RenderAll(FrameWork& work) {
  std::vector<TileSamples> taken;
  while (const auto samples = work.Take(kPlenty, kAnyTile)) {
    taken.push_back(*samples);
    work.RecordCost(*samples, 1e-6 * samples->range.size);
    EXPECT_TRUE(work.Finish(*samples));
  }
  return taken;
}

TEST(FrameWork, AnAdaptiveTileIsOpenOnlyToItsGoal) {
  const FrameSpec spec = AdaptiveFrame(kFirst * 3);
  FrameWork work(spec);
  for (const TileSamples& samples : RenderAll(work)) {
    EXPECT_LE(samples.range.end(), kFirst);
    EXPECT_TRUE(IsUnitRange(spec, samples.range)) << samples.range.Text();
  }
  EXPECT_FALSE(work.HasOpen());
  EXPECT_FALSE(work.Complete());
  EXPECT_TRUE(work.SetGoal(2, {kFirst * 2, false, {}}));
  EXPECT_FALSE(work.SetGoal(2, {kFirst * 2, false, {}})) << "nothing new";
  EXPECT_EQ(RenderAll(work), (std::vector<TileSamples>{{2, {kFirst, kFirst}}}));
  EXPECT_TRUE(work.SetGoal(2, {kFirst * 3, true, {}}));
  EXPECT_EQ(RenderAll(work), (std::vector<TileSamples>{{2, {kFirst * 2, kFirst}}}));
}

TEST(FrameWork, TilesThatStopCompleteTheFrame) {
  FrameWork work(AdaptiveFrame(kFirst * 4));
  RenderAll(work);
  for (uint32_t tile = 0; tile < 4; ++tile) {
    EXPECT_FALSE(work.Complete());
    EXPECT_FALSE(work.SetGoal(tile, {kFirst, true, {}}));
  }
  EXPECT_TRUE(work.Complete());
}

TEST(FrameWork, SamplesBeyondAStopCountAsDoneAndNeverOpen) {
  FrameWork work(AdaptiveFrame(kFirst * 4));
  const TileSamples early{1, {kFirst * 2, kFirst}};
  EXPECT_TRUE(work.Finish(early)) << "merged by a former process";
  EXPECT_FALSE(work.SetGoal(1, {kFirst, true, {}}));
  const TileSamples beyond{1, {kFirst, kFirst}};
  EXPECT_TRUE(work.IsDone(beyond));
  EXPECT_FALSE(work.Finish(beyond));
  work.GiveBack(beyond, {});
  for (const TileSamples& samples : RenderAll(work)) EXPECT_LE(samples.range.end(), kFirst);
}

// The first doubling has measured what a sample of a pixel costs.
TEST(FrameWork, SamplesOfFewPixelsCostLess) {
  FrameWork work(AdaptiveFrame(kFirst * 4));
  RenderAll(work);
  const TileSamples next{0, {kFirst, kFirst}};
  const double whole = *work.Cost(next);
  std::vector<bool> quarter(64);
  std::fill_n(quarter.begin(), 16, true);
  EXPECT_TRUE(work.SetGoal(0, {kFirst * 2, false, PixelMask::Of(quarter)}));
  EXPECT_EQ(work.Pixels(0), PixelMask::Of(quarter));
  EXPECT_EQ(work.PixelCount(0), 16u);
  EXPECT_DOUBLE_EQ(*work.Cost(next), whole / 4);
  EXPECT_NEAR(*work.OpenCost(), whole / 4, whole * 1e-9);
  EXPECT_EQ(RenderAll(work), std::vector<TileSamples>{next});
  EXPECT_NEAR(*work.OpenCost(), 0, whole * 1e-9);
}

TEST(FrameWork, EarlySamplesAreNotOpenedAgain) {
  FrameWork work(AdaptiveFrame(kFirst * 4));
  EXPECT_TRUE(work.Finish({0, {kFirst, kFirst / 2}}));
  RenderAll(work);
  EXPECT_TRUE(work.SetGoal(0, {kFirst * 2, false, {}}));
  EXPECT_EQ(RenderAll(work), (std::vector<TileSamples>{{0, {kFirst + kFirst / 2, kFirst / 2}}}));
}

}  // namespace
}  // namespace tessera
