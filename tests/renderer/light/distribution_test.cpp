#include "renderer/math/distribution.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/chi_square.h"

namespace tessera {
namespace {

std::vector<float> RandomWeights(size_t count, uint64_t seed) {
  TestRandom random(seed);
  std::vector<float> weights(count);
  for (float& w : weights) {
    const float value = random.Next();
    w = value < 0.3f ? 0 : value * value * value;
  }
  return weights;
}

TEST(Distribution1D, DensityIsProportionalToTheWeights) {
  const std::vector<float> weights = RandomWeights(37, 1);
  const Distribution1D distribution(weights);
  const float total = std::accumulate(weights.begin(), weights.end(), 0.0f);
  for (uint32_t i = 0; i < weights.size(); ++i) {
    EXPECT_NEAR(distribution.Pmf(i), weights[i] / total, 1e-6f);
    EXPECT_NEAR(distribution.Pdf((static_cast<float>(i) + 0.5f) / 37), weights[i] / total * 37, 1e-4f);
  }
  EXPECT_NEAR(distribution.mean(), total / 37, 1e-6f);
}

TEST(Distribution1D, SamplesLieInTheirCellAndNeverInAnEmptyOne) {
  std::vector<float> weights = RandomWeights(1000, 2);
  weights.front() = weights.back() = 0;
  weights[500] = 1e9f;  // only rounding errors are left for the others
  const Distribution1D distribution(weights);
  for (int i = 0; i < 100000; ++i) {
    const float u = static_cast<float>(i) / 100000;
    const Distribution1D::Drawn drawn = distribution.Sample(u);
    ASSERT_GT(weights[drawn.cell], 0) << u;
    ASSERT_EQ(static_cast<uint32_t>(drawn.x * 1000), drawn.cell) << u;
    ASSERT_FLOAT_EQ(drawn.pdf, distribution.Pdf(drawn.x)) << u;
  }
  EXPECT_GT(weights[distribution.Sample(0x1.fffffep-1f).cell], 0);
}

TEST(Distribution1D, IsUniformIfAllCellsAreEmpty) {
  const Distribution1D distribution(std::vector<float>(8, 0.0f));
  EXPECT_FLOAT_EQ(distribution.Pdf(0.1f), 1);
  EXPECT_NEAR(distribution.Sample(0.7f).x, 0.7f, 1e-6f);
}

TEST(Distribution1D, InvertUndoesSample) {
  const Distribution1D distribution(RandomWeights(50, 3));
  TestRandom random(4);
  for (int i = 0; i < 1000; ++i) {
    const float u = random.Next();
    EXPECT_NEAR(distribution.Invert(distribution.Sample(u).x), u, 2e-5f);
  }
  EXPECT_EQ(distribution.Pdf(-0.1f), 0);
  EXPECT_EQ(distribution.Pdf(1.1f), 0);
}

TEST(Distribution1D, SamplesIncreaseWithTheNumber) {
  const Distribution1D distribution(RandomWeights(777, 5));
  float before = 0;
  for (int i = 0; i < 50000; ++i) {
    const float x = distribution.Sample(static_cast<float>(i) / 50000).x;
    ASSERT_GE(x, before);
    before = x;
  }
}

TEST(Distribution2D, SamplesFollowTheDensity) {
  const Distribution2D distribution(RandomWeights(20 * 10, 6), 20, 10);
  TestRandom random(7);
  constexpr int kDraws = 200000;
  std::vector<chi_square::Cell> cells(20 * 10);
  for (uint32_t i = 0; i < 200; ++i) {
    cells[i].expected = static_cast<double>(distribution.CellPdf(i % 20, i / 20)) / 200 * kDraws;
  }
  for (int i = 0; i < kDraws; ++i) {
    const Point2 p = distribution.Sample(random.Next2<Point2>()).p;
    ++cells[static_cast<size_t>(p.y * 10) * 20 + static_cast<size_t>(p.x * 20)].observed;
  }
  std::string text;
  EXPECT_GT(chi_square::PooledPValue(cells, text), 1e-4) << text;
}

TEST(Distribution2D, CellDensitiesIntegrateToOneAndMatchSamples) {
  const Distribution2D distribution(RandomWeights(64 * 33, 8), 64, 33);
  double total = 0;
  for (uint32_t y = 0; y < 33; ++y) {
    for (uint32_t x = 0; x < 64; ++x) total += distribution.CellPdf(x, y);
  }
  EXPECT_NEAR(total / (64 * 33), 1, 1e-5);
  TestRandom random(9);
  for (int i = 0; i < 1000; ++i) {
    const Point2 u = random.Next2<Point2>();
    const Distribution2D::Drawn drawn = distribution.Sample(u);
    EXPECT_FLOAT_EQ(drawn.pdf, distribution.CellPdf(drawn.x, drawn.y));
    EXPECT_FLOAT_EQ(drawn.pdf, distribution.Pdf(drawn.p));
    const Point2 back = distribution.Invert(drawn.p);
    EXPECT_NEAR(back.x, u.x, 1e-4f);
    EXPECT_NEAR(back.y, u.y, 1e-4f);
  }
}

}  // namespace
}  // namespace tessera
