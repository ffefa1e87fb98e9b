#include "tests/chi_square.h"

#include <gtest/gtest.h>

#include "renderer/math/vec.h"

namespace tessera {
namespace {

TEST(ChiSquare, TailProbabilitiesAreThoseOfTheTables) {
  EXPECT_NEAR(chi_square::PValue(3.841, 1), 0.05, 1e-4);
  EXPECT_NEAR(chi_square::PValue(18.307, 10), 0.05, 1e-4);
  EXPECT_NEAR(chi_square::PValue(2.558, 10), 0.99, 1e-4);
  EXPECT_NEAR(chi_square::PValue(149.449, 100), 0.001, 1e-5);
}

TEST(ChiSquare, UniformSamplesOfTheSquarePassAndATiltedDensityFails) {
  TestRandom random(7);
  const auto sample = [&]() -> std::optional<Point2> { return random.Next2<Point2>(); };
  const ChiSquareResult good = ChiSquare({}, sample, [](float, float) { return 1.f; });
  EXPECT_TRUE(good.Passes()) << good.text;
  EXPECT_NEAR(good.pdf_total, 1, 1e-6);
  const ChiSquareResult bad = ChiSquare({}, sample, [](float x, float) { return 0.95f + 0.1f * x; });
  EXPECT_FALSE(bad.Passes()) << bad.text;
}

TEST(ChiSquare, FailedSamplesAreTheMassThatTheDensityLacks) {
  TestRandom random(8);
  const auto sample = [&]() -> std::optional<Point2> {
    const Point2 p = random.Next2<Point2>();
    if (p.x > 0.5f) return std::nullopt;
    return p;
  };
  const ChiSquareResult good = ChiSquare({}, sample, [](float x, float) { return x < 0.5f ? 1.f : 0.f; });
  EXPECT_TRUE(good.Passes()) << good.text;
  EXPECT_FALSE(ChiSquare({}, sample, [](float, float) { return 1.f; }).Passes());
  EXPECT_FALSE(ChiSquare({}, sample, [](float x, float) { return x < 0.5f ? 2.f : 0.f; }).Passes());
}

TEST(ChiSquare, DensityAboveOneInTotalFails) {
  TestRandom random(9);
  const auto sample = [&]() -> std::optional<Point2> { return random.Next2<Point2>(); };
  EXPECT_FALSE(ChiSquare({}, sample, [](float, float) { return 1.1f; }).Passes());
}

}  // namespace
}  // namespace tessera
