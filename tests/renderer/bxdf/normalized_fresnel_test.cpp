#include "renderer/bxdf/normalized_fresnel_bxdf.h"

#include <gtest/gtest.h>

#include "tests/chi_square.h"

namespace tessera {
namespace {

TEST(NormalizedFresnel, UniformLightGivesOne) {
  for (const float eta : {1.0f, 1.33f, 2.0f}) {
    const float transmittance = NormalizedFresnelBxdf::HemisphericalTransmittance(eta);
    EXPECT_LE(transmittance, 1);
    const NormalizedFresnelBxdf bxdf(eta, transmittance);
    TestRandom random(1);
    double sum = 0;
    constexpr int kCount = 20000;
    for (int n = 0; n < kCount; ++n) {
      const auto s = bxdf.Sample({0, 0.6f, -0.8f}, 0, random.Next2<Point2>());
      if (s) sum += static_cast<double>(s->f[0] * AbsCosTheta(s->wi) / s->pdf) / kCount;
    }
    EXPECT_NEAR(sum, 1, 0.005) << eta;
  }
}

// It is one half of a reciprocal function of two points, so not reciprocal itself.
TEST(NormalizedFresnel, SamplesFollowTheirDensityOnEitherSide) {
  const NormalizedFresnelBxdf bxdf(1.33f, NormalizedFresnelBxdf::HemisphericalTransmittance(1.33f));
  TestRandom random(2);
  for (const Vec3 wo : {Vec3{0, 0, 1}, Vec3{0.6f, 0, -0.8f}}) {
    const ChiSquareResult result = ChiSquareSphere<Vec3>(
        [&]() -> std::optional<Vec3> {
          const auto sample = bxdf.Sample(wo, 0, random.Next2<Point2>());
          if (!sample) return std::nullopt;
          EXPECT_FLOAT_EQ(sample->pdf, bxdf.Evaluate(wo, sample->wi).pdf);
          return sample->wi;
        },
        [&](Vec3 wi) { return bxdf.Evaluate(wo, wi).pdf; });
    EXPECT_TRUE(result.Passes(2)) << result.text;
  }
}

}  // namespace
}  // namespace tessera
