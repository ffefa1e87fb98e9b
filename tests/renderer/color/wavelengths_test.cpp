#include "renderer/color/wavelengths.h"

#include <cmath>

#include <gtest/gtest.h>

#include "renderer/math/vec.h"
#include "tests/chi_square.h"

namespace tessera {
namespace {

TEST(SampledWavelengths, EachOfTheFourFollowsTheVisiblePdf) {
  for (int i = 0; i < 4; ++i) {
    TestRandom random(static_cast<uint64_t>(i) + 1);
    const auto sample = [&]() -> std::optional<Point2> {
      const SampledWavelengths wavelengths = SampledWavelengths::SampleVisible(random.Next());
      return Point2{wavelengths.lambda[i], random.Next()};
    };
    const ChiSquareGrid grid{.x0 = kLambdaMin, .x1 = kLambdaMax, .cells_x = 94, .cells_y = 1};
    const ChiSquareResult result =
        ChiSquare(grid, sample, [](float lambda, float) { return SampledWavelengths::VisiblePdf(lambda); });
    EXPECT_TRUE(result.Passes(4)) << result.text;
    EXPECT_NEAR(result.pdf_total, 1, 1e-4);
  }
}

TEST(SampledWavelengths, ReportedPdfIsTheVisiblePdf) {
  TestRandom random(5);
  for (int n = 0; n < 10000; ++n) {
    const SampledWavelengths wavelengths = SampledWavelengths::SampleVisible(random.Next());
    for (int i = 0; i < 4; ++i) {
      // The density is constant in cells, and a wavelength may be rounded to the edge of its own.
      const float lambda = wavelengths.lambda[i];
      const float pdf = SampledWavelengths::VisiblePdf(lambda);
      const float pdf_below = SampledWavelengths::VisiblePdf(std::nextafter(lambda, 0.0f));
      ASSERT_TRUE(wavelengths.pdf[i] == pdf || wavelengths.pdf[i] == pdf_below) << lambda;
    }
  }
}

TEST(SampledWavelengths, AverageOfOneOverPdfIsTheLengthOfTheRange) {
  constexpr int kCount = 100000;
  double sum = 0;
  for (int n = 0; n < kCount; ++n) {
    const float u = (static_cast<float>(n) + 0.5f) / kCount;
    sum += static_cast<double>(Average(SafeDiv(Float4(1), SampledWavelengths::SampleVisible(u).pdf)));
  }
  EXPECT_NEAR(sum / kCount, kLambdaMax - kLambdaMin, 0.2);
}

TEST(SampledWavelengths, FourAreAQuarterTurnApart) {
  const SampledWavelengths a = SampledWavelengths::SampleVisible(0.1f);
  const SampledWavelengths b = SampledWavelengths::SampleVisible(0.35f);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(a.lambda[(i + 1) % 4], b.lambda[i], 1e-2);
}

TEST(SampledWavelengths, IndexIsTheNearestWholeNanometreInsideTheTable) {
  const float largest = std::nextafter(1.0f, 0.0f);
  for (const float u : {0.0f, 0.1f, 0.2499999f, 0.25f, 0.7f, largest}) {
    const SampledWavelengths wavelengths = SampledWavelengths::SampleVisible(u);
    alignas(16) int index[4];
    _mm_store_si128(reinterpret_cast<__m128i*>(index), wavelengths.index);
    for (int i = 0; i < 4; ++i) {
      EXPECT_GE(wavelengths.lambda[i], kLambdaMin);
      EXPECT_LE(wavelengths.lambda[i], kLambdaMax);
      EXPECT_GE(index[i], 0);
      EXPECT_LT(index[i], kLambdaCount);
      EXPECT_LE(std::abs(wavelengths.lambda[i] - static_cast<float>(kLambdaMin + index[i])), 0.5f);
    }
  }
}

TEST(SampledWavelengths, VisiblePdfIsZeroOutsideTheRange) {
  EXPECT_EQ(SampledWavelengths::VisiblePdf(359.9f), 0);
  EXPECT_EQ(SampledWavelengths::VisiblePdf(830.1f), 0);
  EXPECT_EQ(SampledWavelengths::VisiblePdf(NAN), 0);
  EXPECT_GT(SampledWavelengths::VisiblePdf(360), 0);
}

TEST(SampledWavelengths, TerminatingKeepsTheEstimateAndHappensOnce) {
  // The estimate of a constant 1 is the average of 1 / pdf: the first wavelength alone must weigh four times.
  SampledWavelengths wavelengths = SampledWavelengths::SampleVisible(0.4f);
  const float hero_pdf = wavelengths.pdf[0];
  EXPECT_FALSE(wavelengths.SecondaryTerminated());
  wavelengths.TerminateSecondary();
  EXPECT_TRUE(wavelengths.SecondaryTerminated());
  EXPECT_FLOAT_EQ(Average(SafeDiv(Float4(1), wavelengths.pdf)), 1 / hero_pdf);
  wavelengths.TerminateSecondary();
  EXPECT_FLOAT_EQ(Average(SafeDiv(Float4(1), wavelengths.pdf)), 1 / hero_pdf);
}

}  // namespace
}  // namespace tessera
