#include "renderer/math/henyey_greenstein.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

constexpr float kAsymmetries[] = {-0.9f, -0.3f, 0.0005f, 0.3f, 0.9f};

// The distribution function of the cosine of the deflection, in closed form (Henyey and Greenstein 1941).
double CosineDistribution(double cos_theta, double g) {
  const double denominator = std::sqrt(1 + g * g - 2 * g * cos_theta);
  return (1 - g * g) / (2 * g) * (1 / denominator - 1 / (1 + g));
}

TEST(HenyeyGreenstein, IsNormalisedOverTheSphere) {
  for (const float g : kAsymmetries) {
    double sum = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const float cos_theta = -1 + 2 * (static_cast<float>(i) + 0.5f) / kSteps;
      sum += static_cast<double>(HenyeyGreenstein(cos_theta, g));
    }
    EXPECT_NEAR(sum * 2 / kSteps * 2 * static_cast<double>(kPi), 1, 1e-3) << g;
  }
}

TEST(HenyeyGreenstein, BothSamplersInvertTheDistributionFunction) {
  for (const float g : kAsymmetries) {
    for (int i = 1; i < 100; ++i) {
      const float u = 0.01f * static_cast<float>(i);
      EXPECT_NEAR(CosineDistribution(SampleHenyeyGreensteinDeflection(g, u), g), u, 1e-3) << g;
      const bool is_isotropic = std::abs(g) < 1e-3f;
      EXPECT_NEAR(CosineDistribution(-SampleHenyeyGreensteinReturn(g, u), g), is_isotropic ? u : 1 - u, 1e-3)
          << g;
    }
  }
}

TEST(HenyeyGreenstein, IsFiniteWhereThePeakIsTooNarrowForFloats) {
  for (const float g : {-1.0f, 1.0f}) {
    for (const float cos_theta : {-1.0f, 0.0f, 1.0f}) {
      EXPECT_EQ(HenyeyGreenstein(cos_theta, g), 0) << g << " " << cos_theta;
    }
  }
}

TEST(HenyeyGreenstein, DirectionAroundAnAxisHasTheCosine) {
  const Vec3 axis = Normalize({1, -2, 3});
  for (const float cos_theta : {-1.0f, -0.4f, 0.0f, 0.7f, 1.0f}) {
    const Vec3 w = DirectionAround(axis, cos_theta, 0.37f);
    EXPECT_NEAR(Length(w), 1, 1e-5);
    EXPECT_NEAR(Dot(w, axis), cos_theta, 1e-5);
  }
}

}  // namespace
}  // namespace tessera
