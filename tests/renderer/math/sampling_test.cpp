// Every map from the square against its density.
#include "renderer/math/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/chi_square.h"

namespace tessera {
namespace {

constexpr float kOneMinusUlp = 0x1.fffffep-1f;
constexpr int kTests = 16;  // chi-square tests in this file, for the level of each

TEST(Sampling, ConcentricDiskIsUniform) {
  TestRandom random(1);
  // Uniform in the disk: the squared radius and the angle are uniform.
  const ChiSquareGrid grid{0, 1, -kPi, kPi, 20, 24, 400000};
  const auto sample = [&]() -> std::optional<Point2> {
    const Point2 p = SampleUniformDiskConcentric(random.Next2<Point2>());
    return Point2{p.x * p.x + p.y * p.y, std::atan2(p.y, p.x)};
  };
  const ChiSquareResult r = ChiSquare(grid, sample, [](float, float) { return kInv2Pi; });
  EXPECT_TRUE(r.Passes(kTests)) << r.text;
  EXPECT_EQ(SampleUniformDiskConcentric({0.5f, 0.5f}), (Point2{0, 0}));
}

TEST(Sampling, ConcentricDiskTakesSquaresToCircles) {
  TestRandom random(7);
  for (int i = 0; i < 10'000; ++i) {
    const Point2 u = random.Next2<Point2>();
    const Point2 p = SampleUniformDiskConcentric(u);
    EXPECT_NEAR(std::hypot(p.x, p.y), std::max(std::abs(2 * u.x - 1), std::abs(2 * u.y - 1)), 2e-7);
  }
}

TEST(Sampling, EighthsOfATurnHaveTheSineAndCosineOfTheLibrary) {
  for (int i = -1000; i <= 1000; ++i) {
    const float x = static_cast<float>(i) / 1000;
    const SineCosine at = SineCosineOfEighth(x);
    const double angle = double{x} * std::numbers::pi / 4;
    EXPECT_NEAR(at.sine, std::sin(angle), 1e-7) << x;
    EXPECT_NEAR(at.cosine, std::cos(angle), 1e-7) << x;
  }
}

TEST(Sampling, CosineHemisphereMatchesItsPdf) {
  TestRandom random(2);
  const ChiSquareResult r = ChiSquareSphere<Vec3>(
      [&]() -> std::optional<Vec3> { return SampleCosineHemisphere(random.Next2<Point2>()); },
      [](Vec3 w) { return w.z > 0 ? CosineHemispherePdf(w.z) : 0; });
  EXPECT_TRUE(r.Passes(kTests)) << r.text;
  EXPECT_NEAR(r.pdf_total, 1, 1e-3);
}

TEST(Sampling, UniformSphereMatchesItsPdf) {
  TestRandom random(3);
  const ChiSquareResult r = ChiSquareSphere<Vec3>(
      [&]() -> std::optional<Vec3> { return SampleUniformSphere(random.Next2<Point2>()); },
      [](Vec3) { return UniformSpherePdf(); });
  EXPECT_TRUE(r.Passes(kTests)) << r.text;
  EXPECT_NEAR(r.pdf_total, 1, 1e-5);
}

TEST(Sampling, UniformHemisphereMatchesItsPdf) {
  TestRandom random(4);
  const ChiSquareResult r = ChiSquareSphere<Vec3>(
      [&]() -> std::optional<Vec3> { return SampleUniformHemisphere(random.Next2<Point2>()); },
      [](Vec3 w) { return w.z > 0 ? UniformHemispherePdf() : 0; });
  EXPECT_TRUE(r.Passes(kTests)) << r.text;
  EXPECT_NEAR(r.pdf_total, 1, 1e-3);
}

TEST(Sampling, DirectionsAreUnitVectors) {
  TestRandom random(5);
  for (int i = 0; i < 10000; ++i) {
    const Point2 u = random.Next2<Point2>();
    EXPECT_NEAR(Length(SampleCosineHemisphere(u)), 1, 1e-6f);
    EXPECT_NEAR(Length(SampleUniformSphere(u)), 1, 1e-6f);
    EXPECT_NEAR(Length(SampleUniformHemisphere(u)), 1, 1e-6f);
    EXPECT_GE(SampleCosineHemisphere(u).z, 0);
  }
  for (const Point2 corner : {Point2{0, 0}, Point2{0, 1}, Point2{1, 0}, Point2{1, 1}}) {
    EXPECT_NEAR(Length(SampleCosineHemisphere(corner)), 1, 1e-6f);
    EXPECT_NEAR(Length(SampleUniformSphere(corner)), 1, 1e-6f);
  }
}

TEST(Sampling, TriangleIsUniform) {
  TestRandom random(6);
  // Uniform in the triangle: (1 - b0)^2 and b1 / (1 - b0) are uniform.
  const auto sample = [&]() -> std::optional<Point2> {
    const Vec3 b = SampleUniformTriangle(random.Next2<Point2>());
    return Point2{(1 - b.x) * (1 - b.x), b.y / (1 - b.x)};
  };
  const ChiSquareResult r = ChiSquare({}, sample, [](float, float) { return 1.f; });
  EXPECT_TRUE(r.Passes(kTests)) << r.text;
}

TEST(Sampling, BarycentricCoordinatesAreNotNegativeAndSumToOne) {
  TestRandom random(7);
  for (int i = 0; i < 10000; ++i) {
    const Vec3 b = SampleUniformTriangle(random.Next2<Point2>());
    EXPECT_GE(std::min(b.x, std::min(b.y, b.z)), 0);
    EXPECT_NEAR(b.x + b.y + b.z, 1, 1e-6f);
  }
}

TEST(Sampling, LinearMatchesItsPdf) {
  TestRandom random(8);
  for (const Point2 ends : {Point2{1, 1}, Point2{0, 1}, Point2{1, 0}, Point2{0.2f, 5}, Point2{5, 0.2f}}) {
    const auto sample = [&]() -> std::optional<Point2> {
      const float u = random.Next();
      const float other = random.Next();
      return Point2{SampleLinear(u, ends.x, ends.y), other};
    };
    const ChiSquareResult r = ChiSquare({0, 1, 0, 1, 50, 2, 200000}, sample,
                                        [&](float x, float) { return LinearPdf(x, ends.x, ends.y); });
    EXPECT_TRUE(r.Passes(kTests)) << ends.x << " " << ends.y << ": " << r.text;
    EXPECT_NEAR(r.pdf_total, 1, 1e-5);
  }
}

TEST(Sampling, LinearStaysBelowOneAndHasNoDensityOutside) {
  EXPECT_LT(SampleLinear(kOneMinusUlp, 0, 1), 1);
  EXPECT_LT(SampleLinear(1, 1, 1), 1);
  EXPECT_EQ(SampleLinear(0, 0, 1), 0);
  EXPECT_EQ(LinearPdf(-0.1f, 1, 2), 0);
  EXPECT_EQ(LinearPdf(1.1f, 1, 2), 0);
}

TEST(Sampling, PowerHeuristicWeightsSumToOne) {
  TestRandom random(9);
  for (int i = 0; i < 1000; ++i) {
    const float f = 100 * random.Next();
    const float g = 100 * random.Next();
    EXPECT_NEAR(PowerHeuristic(f, g) + PowerHeuristic(g, f), 1, 1e-6f);
  }
  EXPECT_EQ(PowerHeuristic(0, 1), 0);
  EXPECT_EQ(PowerHeuristic(1, 0), 1);
  EXPECT_EQ(PowerHeuristic(0, 0), 0);
  EXPECT_EQ(PowerHeuristic(1e30f, 1), 1);
  EXPECT_EQ(PowerHeuristic(1, 1e30f), 0);
  EXPECT_EQ(PowerHeuristic(INFINITY, 1), 1);
}

}  // namespace
}  // namespace tessera
