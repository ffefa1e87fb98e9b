#include "renderer/math/windowed_distribution.h"

#include <gtest/gtest.h>

#include "tests/chi_square.h"

namespace tessera {
namespace {

using Window = WindowedDistribution2D::Window;

constexpr uint32_t kWidth = 7, kHeight = 5;

WindowedDistribution2D RandomTable(uint64_t seed) {
  TestRandom random(seed);
  std::vector<float> weights(kWidth * kHeight);
  for (float& weight : weights) weight = std::max(0.0f, random.Next() - 0.2f);
  return {weights, kWidth, kHeight};
}

TEST(WindowedDistribution2D, SamplesFollowTheDensityInAnyWindow) {
  const WindowedDistribution2D distribution = RandomTable(1);
  TestRandom random(2);
  const Window windows[] = {
      {}, {{0.13f, 0.27f}, {0.71f, 0.94f}}, {{0.5f, 0.4f}, {0.52f, 0.9f}}, {{0, 0}, {1.0f / 7, 1}}};
  for (const Window& window : windows) {
    const ChiSquareGrid grid{window.min.x, window.max.x, window.min.y, window.max.y, 14, 15, 100000};
    const ChiSquareResult result = ChiSquare(
        grid,
        [&]() -> std::optional<Point2> {
          const auto drawn = distribution.Sample(random.Next2<Point2>(), window);
          if (!drawn) return std::nullopt;
          return drawn->p;
        },
        [&](float x, float y) {
          return distribution.Pdf({x, y}, window);
        });
    EXPECT_TRUE(result.Passes(4)) << result.text;
    EXPECT_NEAR(result.pdf_total, 1, 1e-3);
  }
}

TEST(WindowedDistribution2D, SamplesLieInTheirCellWithItsDensity) {
  const WindowedDistribution2D distribution = RandomTable(3);
  TestRandom random(4);
  const Window window{{0.1f, 0.3f}, {0.9f, 0.8f}};
  for (int i = 0; i < 20000; ++i) {
    const auto drawn = distribution.Sample(random.Next2<Point2>(), window);
    ASSERT_TRUE(drawn);
    ASSERT_EQ(static_cast<uint32_t>(static_cast<double>(drawn->p.x) * kWidth), drawn->x);
    ASSERT_EQ(static_cast<uint32_t>(static_cast<double>(drawn->p.y) * kHeight), drawn->y);
    ASSERT_FLOAT_EQ(drawn->pdf, distribution.Pdf(drawn->p, window));
    ASSERT_GT(drawn->pdf, 0);
  }
}

TEST(WindowedDistribution2D, GivesNothingWhereAllIsEmpty) {
  std::vector<float> weights(16, 0.0f);
  weights[0] = 1;
  const WindowedDistribution2D distribution(weights, 4, 4);
  EXPECT_FALSE(distribution.Sample({0.5f, 0.5f}, {{0.5f, 0.5f}, {1, 1}}));
  EXPECT_FALSE(distribution.Sample({0.5f, 0.5f}, {{0.1f, 0.1f}, {0.1f, 0.2f}}));
  EXPECT_EQ(distribution.Pdf({0.7f, 0.7f}, {{0.5f, 0.5f}, {1, 1}}), 0);
  const auto drawn = distribution.Sample({0.999f, 0.999f}, {});
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->x + drawn->y, 0u);
}

}  // namespace
}  // namespace tessera
