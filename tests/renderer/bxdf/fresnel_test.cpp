#include "renderer/bxdf/fresnel.h"

#include <gtest/gtest.h>

#include <complex>

namespace tessera {
namespace {

// Fresnel's equations in their textbook form, in double precision.
double ReferenceFresnel(double cos_i, std::complex<double> eta) {
  using C = std::complex<double>;
  const C cos_t = std::sqrt(C(1) - (1 - cos_i * cos_i) / (eta * eta));
  const C parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const C perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  return (std::norm(parallel) + std::norm(perpendicular)) / 2;
}

TEST(Fresnel, ConductorAgreesWithComplexArithmetic) {
  const Float4 eta(0.2f, 1.5f, 4.3f, 1.0f), k(3.9f, 0.0f, 5.2f, 0.3f);
  for (float cos_i = 0.02f; cos_i <= 1; cos_i += 0.07f) {
    const SampledSpectrum value = FrConductor(cos_i, eta, k);
    for (int i = 0; i < 4; ++i) {
      EXPECT_NEAR(value[i], ReferenceFresnel(cos_i, {eta[i], k[i]}), 2e-5)
          << "cos " << cos_i << " element " << i;
    }
  }
}

TEST(Fresnel, ConductorWithoutAnIndexIsBlackAndNotNan) {
  EXPECT_FALSE(AnyNonZero(FrConductor(1, SampledSpectrum(0.0f), SampledSpectrum(0.0f))));
}

TEST(Fresnel, DielectricAgreesWithComplexArithmeticAndReflectsTotally) {
  for (float cos_i = 0.02f; cos_i <= 1; cos_i += 0.07f) {
    EXPECT_NEAR(FrDielectric(cos_i, 1.5f), ReferenceFresnel(cos_i, 1.5), 1e-5);
    EXPECT_NEAR(FrDielectric(-cos_i, 1.5f), ReferenceFresnel(cos_i, 1 / 1.5), 1e-5);
  }
  EXPECT_EQ(FrDielectric(-0.5f, 1.5f), 1) << "60 degrees inside glass is past the critical angle";
}

TEST(Fresnel, RefractedRayReflectsAsMuchOnItsWayBack) {
  const Vec3 n{0, 0, 1};
  for (float cos_i = 0.05f; cos_i < 1; cos_i += 0.1f) {
    const Vec3 w{SafeSqrt(1 - cos_i * cos_i), 0, cos_i};
    const Refraction in = Refract(w, n, 1.5f);
    ASSERT_TRUE(in.exists);
    EXPECT_NEAR(w.x, -1.5f * in.wt.x, 1e-6) << "Snell's law";
    EXPECT_NEAR(Length(in.wt), 1, 1e-6);
    EXPECT_NEAR(FrDielectric(w.z, 1.5f), FrDielectric(in.wt.z, 1.5f), 1e-5);
    const Refraction out = Refract(in.wt, n, 1.5f);
    ASSERT_TRUE(out.exists);
    EXPECT_NEAR(Distance(out.wt, w), 0, 1e-5);
    EXPECT_FLOAT_EQ(in.etap * out.etap, 1);
  }
}

}  // namespace
}  // namespace tessera
