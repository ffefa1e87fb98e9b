#include "renderer/medium/phase_function.h"

#include <gtest/gtest.h>

#include "tests/chi_square.h"

namespace tessera {
namespace {

constexpr float kAsymmetries[] = {-0.9f, -0.4f, -0.001f, 0, 0.0005f, 0.3f, 0.7f, 0.95f};

TEST(PhaseFunction, SampledDirectionsFollowTheirPdf) {
  for (const float g : kAsymmetries) {
    const PhaseFunction phase(g);
    for (const Vec3 wo : {Vec3{0, 0, 1}, Normalize(Vec3{1, -2, 0.5f})}) {
      TestRandom random(7);
      const ChiSquareResult result = ChiSquareSphere<Vec3>(
          [&]() -> std::optional<Vec3> { return phase.Sample(wo, random.Next2<Point2>()).wi; },
          [&](Vec3 wi) { return phase.Pdf(wo, wi); });
      EXPECT_TRUE(result.Passes(2 * std::size(kAsymmetries))) << g << ": " << result.text;
      EXPECT_NEAR(result.pdf_total, 1, 1e-3) << g;
    }
  }
}

TEST(PhaseFunction, SamplesHaveTheirDensityAndUnitLength) {
  TestRandom random(1);
  for (const float g : kAsymmetries) {
    const PhaseFunction phase(g);
    for (int i = 0; i < 1000; ++i) {
      const Vec3 wo = Normalize(Vec3{random.Next() - 0.5f, random.Next() - 0.5f, random.Next() - 0.5f});
      const PhaseSample sample = phase.Sample(wo, random.Next2<Point2>());
      ASSERT_NEAR(Length(sample.wi), 1, 1e-5);
      // Near the peak the density is steep, and the cosine of rounded directions is less exact than the one
      // drawn.
      ASSERT_NEAR(phase.Evaluate(wo, sample.wi) / sample.pdf, 1, std::abs(g) > 0.8f ? 2e-2 : 1e-3) << g;
    }
  }
}

TEST(PhaseFunction, AsymmetryIsTheMeanCosineOfTheDeflection) {
  constexpr int kSide = 256;
  const Vec3 wo{0, 0.6f, 0.8f};
  for (const float g : kAsymmetries) {
    double sum = 0;
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide; ++j) {
        const Point2 u{(static_cast<float>(i) + 0.5f) / kSide, (static_cast<float>(j) + 0.5f) / kSide};
        sum -= static_cast<double>(Dot(wo, PhaseFunction(g).Sample(wo, u).wi));
      }
    }
    EXPECT_NEAR(sum / (kSide * kSide), g, 2e-3);
  }
}

TEST(PhaseFunction, IsReciprocal) {
  TestRandom random(3);
  for (int i = 0; i < 100; ++i) {
    const Vec3 a = PhaseFunction(0).Sample({0, 0, 1}, random.Next2<Point2>()).wi;
    const Vec3 b = PhaseFunction(0).Sample({0, 0, 1}, random.Next2<Point2>()).wi;
    ASSERT_EQ(PhaseFunction(0.6f).Evaluate(a, b), PhaseFunction(0.6f).Evaluate(b, a));
  }
}

TEST(PhaseFunction, ExtremesStayFinite) {
  for (const float g : {-1.0f, 1.0f}) {
    for (const float u : {0.0f, 0.5f, 0x1.fffffep-1f}) {
      const PhaseSample sample = PhaseFunction(g).Sample({0, 0, 1}, {u, u});
      EXPECT_TRUE(std::isfinite(sample.pdf) && sample.pdf > 0);
      EXPECT_NEAR(Length(sample.wi), 1, 1e-5);
    }
  }
}

}  // namespace
}  // namespace tessera
