// The decisions of adaptive frames: which units there are, what is estimated, when a tile stops.
#include "renderer/film/adaptive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/renderer/film/adaptive_frames.h"

namespace tessera {
namespace {

constexpr uint32_t kFirst = kDecisionSamplesMin;

TEST(Adaptive, GoalsDoubleUpToTheLastSample) {
  const FrameSpec spec = AdaptiveSpec(kFirst * 5, 0.1);
  TileGoal goal = FirstGoal(spec);
  EXPECT_EQ(goal, (TileGoal{kFirst, false, {}}));
  for (const TileGoal& next :
       {TileGoal{kFirst * 2, false, {}}, TileGoal{kFirst * 4, false, {}}, TileGoal{kFirst * 5, true, {}}}) {
    goal = NextGoal(spec, goal.samples, {});
    EXPECT_EQ(goal, next);
  }
  const PixelMask some = PixelMask::Of({true, false});
  EXPECT_EQ(NextGoal(AdaptiveSpec(kFirst * 2, 0.1), kFirst, some), (TileGoal{kFirst * 2, true, some}));
}

TEST(Adaptive, AFrameWithoutThresholdOrWithFewSamplesHasOneGoal) {
  EXPECT_EQ(FirstGoal(AdaptiveSpec(100, 0)), (TileGoal{100, true, {}}));
  EXPECT_EQ(FirstGoal(AdaptiveSpec(kFirst, 0.1)), (TileGoal{kFirst, true, {}}));
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

// Sums of a tile of one row: pixels of half a doubling of `samples`, R alone, with these means.
FrameSpec RowSpec() {
  FrameSpec spec = AdaptiveSpec(100, 0);
  spec.channels = ColorsAndWeight({"R"});
  spec.SetNoiseThreshold(0.1);
  return spec;
}

std::vector<float> Row(uint32_t samples, const std::vector<float>& means) {
  std::vector<float> sums;
  for (const float mean : means) {
    const auto count = static_cast<float>(samples / 2);
    sums.insert(sums.end(), {mean * count, count, count});
  }
  return sums;
}

std::vector<double> Noise(const FrameSpec& spec, uint32_t samples, int width, const std::vector<float>& left,
                          const std::vector<float>& right) {
  return EstimateNoise(spec.Layout(), {samples, width, left, right});
}

TEST(Adaptive, TheEstimateOfAPixelIsThatOfItsFormula) {
  FrameSpec spec = AdaptiveSpec(100, 0);
  spec.channels = ColorsAndWeight({"R", "depth", "G"});
  spec.SetNoiseThreshold(0.1);
  // Means of halves: R 1 and 2, G 0 and 0.5; depth is not looked at.
  const std::vector<float> left{8, 800, 0, 8, 8};
  const std::vector<float> right{16, 0, 4, 8, 8};
  const double r = 0.5 * 0.5 / (1.5 * 1.5 + 0.01);
  const double g = 0.25 * 0.25 / (0.25 * 0.25 + 0.01);
  EXPECT_NEAR(Noise(spec, 16, 1, left, right).at(0), (r + g) / 2, 1e-7);
}

// Against sums over all pairs of pixels, the weights from their formula.
TEST(Adaptive, APixelIsJudgedByThoseAroundItAndByItsTile) {
  const FrameSpec spec = RowSpec();
  const auto binomial = [](int distance) {
    return std::tgamma(17.0) / (std::tgamma(9.0 + distance) * std::tgamma(9.0 - distance));
  };
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> draw(0.5f, 1.5f);
  constexpr int kWidth = 13, kHeight = 11;
  std::vector<float> left_means, right_means;
  std::vector<double> q;
  for (int p = 0; p < kWidth * kHeight; ++p) {
    const float left = draw(generator), right = draw(generator);
    left_means.push_back(left);
    right_means.push_back(right);
    const double mean = (left + right) / 2.0, error = (left - right) / 2.0;
    q.push_back(error * error / (mean * mean + 0.01));
  }
  std::vector<float> left = Row(32, left_means), right = Row(32, right_means);
  std::vector<bool> open(q.size(), true);
  for (const size_t p : {0, 5, 17, 80}) {  // stopped before: fewer samples, which say nothing
    open[p] = false;
    for (int c = 0; c < 3; ++c) right[p * 3 + static_cast<size_t>(c)] = 0;
  }
  const std::vector<double> noise = Noise(spec, 32, kWidth, left, right);
  double tile = 0, count = 0;
  for (size_t p = 0; p < q.size(); ++p) {
    tile += open[p] ? q[p] : 0;
    count += open[p] ? 1 : 0;
  }
  for (int at = 0; at < kWidth * kHeight; ++at) {
    double sum = 0, weights = 0;
    for (int p = 0; p < kWidth * kHeight; ++p) {
      const int dx = std::abs(at % kWidth - p % kWidth), dy = std::abs(at / kWidth - p / kWidth);
      if (!open[static_cast<size_t>(p)] || dx > 8 || dy > 8) continue;
      const double weight = binomial(dx) * binomial(dy);
      weights += weight;
      sum += weight * q[static_cast<size_t>(p)];
    }
    const double expected = 0.75 * sum / weights + 0.25 * tile / count;
    EXPECT_NEAR(noise[static_cast<size_t>(at)], open[static_cast<size_t>(at)] ? expected : 0, 1e-5) << at;
  }
}

TEST(Adaptive, TheThresholdIsThatOfAPixelWithAsManySamplesAsItSays) {
  FrameSpec spec = RowSpec();
  spec.samples_per_pixel = kSamplesPerPixelMax;
  // An error of 0.2 of the mean: noise 0.04 / 1.01, which is the threshold's where 0.01 n / 256 is as much.
  const double n = 0.04 / 1.01 * kThresholdSamples / 0.01;
  for (const auto& [samples, wanted] : {std::pair{static_cast<uint32_t>(n * 0.98) / 2 * 2, 2u},
                                        std::pair{static_cast<uint32_t>(n * 1.02) / 2 * 2, 0u}}) {
    const std::vector<float> left = Row(samples, {0.8f, 0.8f}), right = Row(samples, {1.2f, 1.2f});
    EXPECT_EQ(NoisyPixels(spec.Layout(), spec.noise_threshold, {samples, 2, left, right}).Count(2), wanted)
        << samples;
  }
}

TEST(Adaptive, APixelThatHasStoppedDoesNotBeginAgain) {
  const FrameSpec spec = RowSpec();
  const std::vector<float> left = Row(32, {0.1f, 0.1f, 0.1f});
  std::vector<float> right = Row(32, {2, 2, 2});
  std::fill_n(&right[3], 3, 0.0f);
  const PixelMask noisy = NoisyPixels(spec.Layout(), spec.noise_threshold, {32, 3, left, right});
  EXPECT_TRUE(noisy.Has(0) && noisy.Has(2));
  EXPECT_FALSE(noisy.Has(1));
}

TEST(Adaptive, NoPixelHasMoreThanItsShareOfSay) {
  const FrameSpec spec = RowSpec();
  std::vector<float> left_means(256, 1.0f);
  const std::vector<float> right = Row(32, left_means);
  left_means[0] = 1e30f;  // one sample as bright as can be
  const std::vector<double> noise = Noise(spec, 32, 16, Row(32, left_means), right);
  EXPECT_NEAR(noise[255], 0.25 / 256, 1e-6) << "far away it speaks as one of the tile";
  EXPECT_LT(noise[0], 0.2) << "a corner has the fewest others around it";
  EXPECT_GT(noise[0], noise[1]);
}

TEST(Adaptive, WhatHasNoWeightIsBlackAndExtremesStayFinite) {
  const FrameSpec spec = RowSpec();
  EXPECT_EQ(Noise(spec, 2, 1, {5, 1, 0}, {7, 1, 0}).at(0), 0);
  const float huge = std::numeric_limits<float>::max(), tiny = std::numeric_limits<float>::denorm_min();
  EXPECT_LT(Noise(spec, 2, 1, {huge, 1, tiny}, {-huge, 1, tiny}).at(0),
            std::numeric_limits<double>::infinity());
}

TEST(Adaptive, ATileMustHaveThePixelsAskedForAndNoOthers) {
  const FrameSpec spec = RowSpec();
  RadianceTile tile{{0, 0, 2, 1}, {0, 16}, {3}, Row(32, {0.5f, 0.7f})};
  const PixelMask first = PixelMask::Of({true, false});
  EXPECT_TRUE(HasExactly(spec.Layout(), {}, tile));
  EXPECT_FALSE(HasExactly(spec.Layout(), first, tile)) << "too much";
  KeepPixels(first, tile);
  EXPECT_TRUE(HasExactly(spec.Layout(), first, tile));
  EXPECT_FALSE(HasExactly(spec.Layout(), {}, tile)) << "too little";
  tile.sums[1] = 15;
  EXPECT_FALSE(HasExactly(spec.Layout(), first, tile)) << "a sample is missing";
}

}  // namespace
}  // namespace tessera
