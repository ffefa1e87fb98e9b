// The decisions of adaptive frames: which units there are, what is estimated, when a tile stops.
#include "film/adaptive.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/renderer/film/adaptive_frames.h"

namespace tessera {
namespace {

constexpr uint32_t kFirst = kDecisionSamplesMin;

TEST(Adaptive, GoalsDoubleUpToTheLastSample) {
  const FrameSpec spec = AdaptiveSpec(kFirst * 5, 0.1);
  TileGoal goal = FirstGoal(spec);
  EXPECT_EQ(goal, (TileGoal{kFirst, false}));
  for (const TileGoal next :
       {TileGoal{kFirst * 2, false}, TileGoal{kFirst * 4, false}, TileGoal{kFirst * 5, true}}) {
    goal = NextGoal(spec, goal.samples);
    EXPECT_EQ(goal, next);
  }
  EXPECT_EQ(NextGoal(AdaptiveSpec(kFirst * 2, 0.1), kFirst), (TileGoal{kFirst * 2, true}));
}

TEST(Adaptive, AFrameWithoutThresholdOrWithFewSamplesHasOneGoal) {
  EXPECT_EQ(FirstGoal(AdaptiveSpec(100, 0)), (TileGoal{100, true}));
  EXPECT_EQ(FirstGoal(AdaptiveSpec(kFirst, 0.1)), (TileGoal{kFirst, true}));
  EXPECT_EQ(FirstUnitMax(AdaptiveSpec(kFirst, 0.1)), kFirst);
}

TEST(Adaptive, NoUnitReachesOverADoubling) {
  const FrameSpec spec = AdaptiveSpec(kFirst * 5, 0.1);
  EXPECT_TRUE(IsUnitRange(spec, {0, 1}));
  EXPECT_TRUE(IsUnitRange(spec, {0, kFirst / 2}));
  EXPECT_FALSE(IsUnitRange(spec, {0, kFirst})) << "its halves would not be known";
  EXPECT_FALSE(IsUnitRange(spec, {0, kFirst * 4}));
  EXPECT_TRUE(IsUnitRange(spec, {kFirst / 2, kFirst / 2}));
  EXPECT_TRUE(IsUnitRange(spec, {kFirst, kFirst}));
  EXPECT_TRUE(IsUnitRange(spec, {kFirst * 4, kFirst}));
  EXPECT_FALSE(IsUnitRange(spec, {kFirst * 4, kFirst * 2})) << "beyond the last sample";
  EXPECT_FALSE(IsUnitRange(spec, {1, 2}));
  EXPECT_FALSE(IsUnitRange(spec, {0, 0}));
  EXPECT_TRUE(IsUnitRange(AdaptiveSpec(kFirst * 5, 0), {0, kFirst * 4}));
}

TEST(Adaptive, UnitsCoverTheSamplesWithoutGapOrOverlap) {
  for (const double threshold : {0.0, 0.1}) {
    for (uint32_t samples = 1; samples < kFirst * 6; ++samples) {
      const FrameSpec spec = AdaptiveSpec(samples, threshold);
      uint32_t end = 0;
      for (const SampleRange range : UnitPartition(spec, samples)) {
        EXPECT_EQ(range.begin, end);
        EXPECT_TRUE(IsUnitRange(spec, range)) << samples << " samples: " << range.Text();
        end = range.end();
      }
      EXPECT_EQ(end, samples);
    }
  }
  EXPECT_EQ(UnitPartition(AdaptiveSpec(100, 0), 100), DyadicPartition(100));
}

TEST(Adaptive, TheEstimateIsThatOfItsFormula) {
  FrameSpec spec = AdaptiveSpec(100, 0.1);
  spec.channels = {"R", "depth", "G", "W"};
  // Two pixels: means of halves (1, 2) and (3, 3), then (0, 0) and (0.5, 0.1); depth is not looked at.
  const std::vector<float> left{8, 800, 24, 8, 0, 0, 4, 8};
  const std::vector<float> right{16, 0, 24, 8, 0, 0, 0.8f, 8};
  const double r = 0.5 * 0.5 / (1.5 * 1.5 + 0.01);
  const double g = 0.2 * 0.2 / (0.3 * 0.3 + 0.01);
  EXPECT_NEAR(EstimateNoise(spec, left, right), (r + 0 + 0 + g) / 4, 1e-7);
}

TEST(Adaptive, TheThresholdIsThatOfATileWithAsManySamplesAsItSays) {
  FrameSpec spec = AdaptiveSpec(100, 0.1);
  spec.channels = {"R", "W"};
  const std::vector<float> left{0.8f, 1}, right{1.2f, 1};   // an error of 0.2 of the mean: noise 0.04 / 1.01
  const double n = 0.04 / 1.01 * kThresholdSamples / 0.01;  // where it is the threshold's
  EXPECT_FALSE(IsEnough(spec, static_cast<uint32_t>(n * 0.99), left, right));
  EXPECT_TRUE(IsEnough(spec, static_cast<uint32_t>(n * 1.01), left, right));
}

TEST(Adaptive, NoPixelHasMoreThanItsShareOfSay) {
  FrameSpec spec = AdaptiveSpec(100, 0.1);
  spec.channels = {"R", "W"};
  std::vector<float> left(200, 1.0f), right(200, 1.0f);
  left[0] = 1e30f;  // one sample as bright as can be
  EXPECT_LE(EstimateNoise(spec, left, right), 1.0 / 100);
  EXPECT_NEAR(EstimateNoise(spec, left, right), 1.0 / 100, 1e-6);
}

TEST(Adaptive, WhatHasNoWeightIsBlackAndExtremesStayFinite) {
  FrameSpec spec = AdaptiveSpec(100, 0.1);
  spec.channels = {"R", "W"};
  EXPECT_EQ(EstimateNoise(spec, {5, 0}, {7, 0}), 0);
  const float huge = std::numeric_limits<float>::max(), tiny = std::numeric_limits<float>::denorm_min();
  const double estimate = EstimateNoise(spec, {huge, tiny}, {-huge, tiny});
  EXPECT_LT(estimate, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace tessera
