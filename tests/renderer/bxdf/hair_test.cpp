// Hair: energy, colour and direction of its lobes.
#include "renderer/bxdf/hair_bxdf.h"

#include <gtest/gtest.h>

#include "renderer/bxdf/fresnel.h"
#include "tests/renderer/bxdf/bxdf_examples.h"
#include "tests/renderer/bxdf/bxdf_means.h"

namespace tessera {
namespace {

constexpr float kIndex = 1.55f;

// The radiance that hair shows in a uniform environment, without its own sampling.
Mean FurnaceOfUniformDirections(const HairBxdf& hair, Vec3 wo, int count) {
  TestRandom random(21);
  return MeanOf(count, [&](int) {
    const Vec3 wi = SampleUniformSphere(random.Next2<Point2>());
    return hair.Evaluate(wo, wi).f[0] * AbsCosTheta(wi) / UniformSpherePdf();
  });
}

TEST(Hair, WhiteHairVanishesInAFurnace) {
  TestRandom random(22);
  for (const float beta : {0.1f, 0.3f, 0.6f, 1.0f}) {
    for (const float alpha : {0.0f, 2.0f}) {
      for (const float h : {-0.95f, 0.0f, 0.4f}) {
        const HairBxdf white(HairFibre(kIndex, beta, beta, alpha), h, SampledSpectrum(0.0f));
        const Vec3 wo = SampleUniformSphere(random.Next2<Point2>());
        const Mean radiance = FurnaceOfUniformDirections(white, wo, 40000);
        EXPECT_NEAR(radiance.value, 1, 4 * radiance.error + 0.002) << beta << " " << alpha << " " << h;
      }
    }
  }
}

TEST(Hair, SamplesOfWhiteHairWeighOne) {
  TestRandom random(23);
  for (const float beta : {0.01f, 0.2f, 1.0f}) {
    for (int n = 0; n < 200; ++n) {
      const HairBxdf white(HairFibre(kIndex, beta, beta, 2), 2 * random.Next() - 1, SampledSpectrum(0.0f));
      const Vec3 wo = SampleUniformSphere(random.Next2<Point2>());
      const float uc = random.Next();
      const auto s = white.Sample(wo, uc, random.Next2<Point2>());
      ASSERT_TRUE(s);
      EXPECT_NEAR(s->f[2] * AbsCosTheta(s->wi) / s->pdf, 1, 1e-3);
    }
  }
}

// The sum over the paths inside a smooth cylinder, in double precision, of what leaves it.
double Remaining(double h, double sin_theta, double sigma_a) {
  const double eta = kIndex, cos_theta = std::sqrt(1 - sin_theta * sin_theta);
  const double cos_theta_t = std::sqrt(1 - sin_theta * sin_theta / (eta * eta));
  const double etap = std::sqrt(eta * eta - sin_theta * sin_theta) / cos_theta;
  const double cos_gamma_t = std::sqrt(1 - h * h / (etap * etap));
  const double crossed = std::exp(-2 * sigma_a * cos_gamma_t / cos_theta_t);
  const double fresnel = FrDielectric(static_cast<float>(cos_theta * std::sqrt(1 - h * h)), kIndex);
  double left = fresnel, inside = (1 - fresnel) * crossed;
  for (int p = 0; p < 100; ++p) {
    left += inside * (1 - fresnel);
    inside *= fresnel * crossed;
  }
  return left;
}

TEST(Hair, AbsorbsAsACylinderDoes) {
  for (const float sigma_a : {0.1f, 0.7f, 3.0f}) {
    for (const float h : {0.0f, 0.7f}) {
      for (const float sin_theta : {0.0f, 0.6f}) {
        const HairBxdf hair(HairFibre(kIndex, 0.3f, 0.3f, 0), h, SampledSpectrum(sigma_a));
        const float r = std::sqrt(1 - sin_theta * sin_theta);
        const Mean radiance = FurnaceOfUniformDirections(hair, {sin_theta, 0.6f * r, 0.8f * r}, 40000);
        EXPECT_NEAR(radiance.value, Remaining(h, sin_theta, sigma_a), 4 * radiance.error + 0.002)
            << sigma_a << " " << h << " " << sin_theta;
      }
    }
  }
}

TEST(Hair, ScalesTurnTheReflectionTowardsTheRoot) {
  const float theta_o = 0.5f;
  const Vec3 wo{std::sin(theta_o), 0, std::cos(theta_o)};
  for (const float alpha : {0.0f, 3.0f}) {
    const HairBxdf hair(HairFibre(kIndex, 0.03f, 0.1f, alpha), 0, SampledSpectrum(1.0f));
    TestRandom random(24);
    double theta_i = 0;
    constexpr int kCount = 4000;
    for (int n = 0; n < kCount; ++n) {
      const auto s = hair.Sample(wo, 1e-4f, random.Next2<Point2>());  // of the lobe R
      ASSERT_TRUE(s);
      theta_i += std::asin(s->wi.x) / kCount;
    }
    EXPECT_NEAR(theta_i, -theta_o + 2 * Radians(alpha), 0.003) << alpha;
  }
}

TEST(Hair, LightPassesStraightThroughTheMiddle) {
  const HairBxdf hair(HairFibre(kIndex, 0.1f, 0.1f, 0), 0, SampledSpectrum(0.0f));
  const Vec3 wo{0, 0, 1};
  EXPECT_GT(hair.Evaluate(wo, {0, 0, -1}).f[0], 20 * hair.Evaluate(wo, {0, 1, 1e-3f}).f[0] * 1e-3f);
  const auto s = hair.Sample(wo, 0.5f, {0.3f, 0.3f});  // of the lobe TT
  ASSERT_TRUE(s);
  EXPECT_LT(s->wi.z, -0.9f);
  EXPECT_TRUE(s->IsTransmission());
}

TEST(Hair, AbsorptionFallsWithTheReflectance) {
  const SampledSpectrum sigma_a = HairBxdf::AbsorptionOfReflectance({1, 0.5f, 0.1f, 0}, 0.3f);
  EXPECT_EQ(sigma_a[0], 0);
  // (ln c / (5.969 - 0.215 b + 2.532 b^2 - 10.73 b^3 + 5.574 b^4 + 0.245 b^5))^2 at b = 0.3
  EXPECT_NEAR(sigma_a[1], 0.0138565f, 1e-6);
  EXPECT_NEAR(sigma_a[2], 0.1529095f, 1e-5);
  EXPECT_GT(sigma_a[3], 1e5f);
}

TEST(Hair, InvalidInputsGiveFiniteValues) {
  for (const float bad : {NAN, INFINITY, -INFINITY, 0.0f, -1.0f, 1e30f}) {
    for (const float h : {bad, 0.5f, 1.0f}) {
      const HairBxdf hair(HairFibre(bad, bad, bad, bad), h, SampledSpectrum(std::abs(bad)));
      TestRandom random(25);
      for (int n = 0; n < 50; ++n) {
        const Vec3 wo = n == 0 ? Vec3{1, 0, 0} : SampleUniformSphere(random.Next2<Point2>());
        const float uc = random.Next();
        const auto s = hair.Sample(wo, uc, random.Next2<Point2>());
        if (!s) continue;
        EXPECT_TRUE(AllFinite(s->f) && std::isfinite(s->pdf)) << bad << " " << h;
        EXPECT_NEAR(Length(s->wi), 1, 1e-3) << bad << " " << h;
      }
    }
  }
}

}  // namespace
}  // namespace tessera
