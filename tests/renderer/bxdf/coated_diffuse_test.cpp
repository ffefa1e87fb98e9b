// The closed form of a coated Lambertian base against the random walk that defines it.
#include "renderer/bxdf/coated_diffuse_bxdf.h"

#include <gtest/gtest.h>

#include "renderer/util/hash.h"
#include "tests/renderer/bxdf/bxdf_examples.h"
#include "tests/renderer/bxdf/bxdf_means.h"

namespace tessera {
namespace {

struct Angles {
  float cos_o, cos_i;
};
constexpr Angles kAngles[] = {{0.95f, 0.9f}, {0.9f, 0.2f}, {0.15f, 0.8f}, {0.1f, 0.12f}};

// Everything but the reflection of the coat, which has a formula.
float WithoutCoat(const BsdfEvaluation& value, const DielectricBxdf& coat, Vec3 wo, Vec3 wi) {
  return value.f[0] - coat.Evaluate(wo, wi, TransportMode::kRadiance, Lobes::kReflection).f[0];
}

void ExpectAgreement(float alpha, float reflectance, float thickness, int depth_max) {
  const DielectricBxdf coat = TestInterface(alpha, alpha, 1.5f);
  const CoatedDiffuseBxdf closed =
      TestCoated(alpha, SampledSpectrum(reflectance), thickness, CoatedDiffuseBxdf::BaseHits(depth_max));
  CoatLayer layer = TestLayer(thickness, 0, 0);
  layer.depth_max = depth_max;
  const LayeredDiffuseBxdf walked(coat, SampledSpectrum(reflectance), layer);
  for (const Angles& angles : kAngles) {
    const Vec3 wo = DirectionAt(angles.cos_o, 0), wi = DirectionAt(angles.cos_i, 2);
    const Mean mean = MeanOf(15000, [&](int n) { return walked.EstimateWalk(wo, wi, Hash(n))[0]; });
    const BsdfEvaluation value = closed.Evaluate(wo, wi);
    const float f = WithoutCoat(value, coat, wo, wi);
    EXPECT_NEAR(mean.value, f, 4 * mean.error + 0.002 * f + 1e-6)
        << "alpha " << alpha << " reflectance " << reflectance << " thickness " << thickness << " depth "
        << depth_max << " cosines " << angles.cos_o << " " << angles.cos_i;
  }
}

TEST(CoatedDiffuse, ClosedFormIsTheMeanOfTheWalk) {
  for (const float alpha : {0.0f, 0.03f, 0.3f, 1.0f}) {
    ExpectAgreement(alpha, 0.8f, 0.01f, 10);
    ExpectAgreement(alpha, 0.4f, 0.1f, 10);
  }
}

TEST(CoatedDiffuse, ClosedFormCountsTheHitsOfAShortWalk) {
  for (const int depth_max : {0, 1, 2, 3, 4, 30}) ExpectAgreement(0.2f, 1, 0.01f, depth_max);
}

TEST(CoatedDiffuse, WhiteFurnaceLosesNothingUnderASmoothThinCoat) {
  const CoatedDiffuseBxdf white = TestCoated(0, SampledSpectrum(1.0f), 1e-6f, 500);
  for (const float cos_o : {1.0f, 0.5f, 0.1f}) EXPECT_NEAR(Furnace(white, cos_o, 4000).value, 1, 0.005);
}

TEST(CoatedDiffuse, WhiteFurnaceLosesWhatSingleScatteringLosesUnderARoughCoat) {
  // Of light that is reflected inside a rough interface again and again: much for rough ones, nearly nothing
  // for sharp ones.
  double last = 1;
  for (const float alpha : {0.01f, 0.1f, 0.3f}) {
    const Mean albedo = Furnace(TestCoated(alpha, SampledSpectrum(1.0f), 1e-6f, 500), 0.7f, 20000);
    EXPECT_LT(albedo.value, last + 4 * albedo.error);
    last = albedo.value;
    EXPECT_GT(albedo.value, 1 - 1.3 * alpha);
  }
  EXPECT_LT(last, 0.9);
}

TEST(CoatedDiffuse, WeightsOfSamplesVaryLittle) {
  const CoatedDiffuseBxdf grey = TestCoated(0.1f, SampledSpectrum(0.5f));
  for (const float cos_o : {1.0f, 0.5f}) {
    const Mean albedo = Furnace(grey, cos_o, 10000);
    EXPECT_LT(albedo.error * 100, 0.35 * albedo.value) << "relative deviation of one sample";
  }
}

TEST(CoatedDiffuse, ScatteringLayerWithoutAbsorptionKeepsItsEnergy) {
  CoatLayer layer = TestLayer(1, 1, 0.4f);
  layer.depth_max = 1000;
  const LayeredDiffuseBxdf white(TestInterface(0, 0, 1.5f), SampledSpectrum(1.0f), layer);
  const Mean albedo = Furnace(white, 0.6f, 30000);
  EXPECT_NEAR(albedo.value, 1, 4 * albedo.error);
  EXPECT_LT(albedo.error, 0.02);
}

TEST(CoatedDiffuse, WalkIsTheSameEveryTime) {
  const LayeredDiffuseBxdf walked(TestInterface(0.3f, 0.3f, 1.5f), FourColors(), TestLayer(0.1f, 0.5f, 0));
  const Vec3 wo = DirectionAt(0.7f, 0), wi = DirectionAt(0.4f, 2);
  const SampledSpectrum once = walked.Evaluate(wo, wi).f, again = walked.Evaluate(wo, wi).f;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(once[i], again[i]);
}

void ExpectSameCoat(const CoatLookup& a, const CoatLookup& b, float tolerance) {
  for (float cos_theta = 0.05f; cos_theta <= 1; cos_theta += 0.05f) {
    EXPECT_NEAR(a.At(cos_theta).transmittance, b.At(cos_theta).transmittance, tolerance) << cos_theta;
    EXPECT_NEAR(a.At(cos_theta).reflectance, b.At(cos_theta).reflectance, tolerance) << cos_theta;
  }
  EXPECT_NEAR(a.internal_reflectance(), b.internal_reflectance(), tolerance);
  EXPECT_NEAR(a.mean_transmittance(), b.mean_transmittance(), tolerance);
}

TEST(CoatTable, InterpolatedRowsAreCloseToComputedOnes) {
  const CoatTable over_alpha = CoatTable::OverAlpha(1.5f, 0.01f);
  for (const float alpha : {0.0f, 0.11f, 0.52f, 0.97f}) {
    ExpectSameCoat(over_alpha.At(alpha), TestCoat(alpha, 0.01f).At(0), 0.006f);
  }
  const CoatTable over_eta = CoatTable::OverEta(0, 1.4f, 1.6f, 0.01f);
  ExpectSameCoat(over_eta.At(1.5f), TestCoat(0, 0.01f).At(0), 0.001f);
}

TEST(CoatTable, SmoothCoatAgreesWithFresnelsFormula) {
  const CoatLookup coat = TestCoat(0, 0.01f).At(0);
  for (float cos_theta = 0.005f; cos_theta <= 1; cos_theta += 0.01f) {
    const float fresnel = FrDielectric(cos_theta, 1.5f);
    const float cos_t = SafeSqrt(1 - (1 - cos_theta * cos_theta) / 2.25f);
    EXPECT_NEAR(coat.At(cos_theta).reflectance, fresnel, 2e-4);
    EXPECT_NEAR(coat.At(cos_theta).transmittance, (1 - fresnel) * std::exp(-0.01f / cos_t), 2e-4);
  }
}

TEST(CoatTable, AnglesOutOfRangeAreClamped) {
  const CoatLookup coat = TestCoat(0, 0.01f).At(0);
  EXPECT_EQ(coat.At(NAN).reflectance, 1);
  EXPECT_EQ(coat.At(-1).reflectance, 1);
  EXPECT_NEAR(coat.At(1.0000005f).reflectance, 0.04f, 1e-5);
}

TEST(CoatTable, EqualCoatsShareTheirTable) {
  CoatTableCache cache;
  EXPECT_EQ(cache.Constant(0.1f, 1.5f, 0.01f), cache.Constant(0.1f, 1.5f, 0.01f));
  EXPECT_NE(cache.Constant(0.1f, 1.5f, 0.01f), cache.Constant(0.1f, 1.5f, 0.02f));
}

}  // namespace
}  // namespace tessera
