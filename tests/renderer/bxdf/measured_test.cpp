// Measured BRDFs: their warps, and a metal that was measured against its formula.
#include "renderer/bxdf/measured_bxdf.h"

#include <gtest/gtest.h>

#include "tests/chi_square.h"
#include "tests/renderer/bxdf/bxdf_examples.h"
#include "tests/renderer/bxdf/measured_tables.h"

namespace tessera {
namespace {

// Two grids of 4 x 3 values, over one parameter each of 2 and 1 values.
Warp2D<2> TwoGrids() {
  return Warp2D<2>::ForSampling({4,
                                 3,
                                 {1, 2, 0, 4, 3, 1, 1, 0, 2, 5, 0, 1,  //
                                  0, 0, 1, 1, 2, 8, 1, 0, 1, 1, 1, 3},
                                 {std::vector<float>{10, 20}, std::vector<float>{5}}});
}

TEST(Warp2D, SamplesMatchTheirDensity) {
  const Warp2D<2> warp = TwoGrids();
  TestRandom random(31);
  for (const float parameter : {0.0f, 10.0f, 13.0f, 20.0f, 99.0f}) {
    const auto sample = [&]() -> std::optional<Point2> {
      return warp.Sample(random.Next2<Point2>(), {parameter, 0}).p;
    };
    const auto pdf = [&](float x, float y) { return warp.Evaluate({x, y}, {parameter, 0}); };
    const ChiSquareResult r = ChiSquare({0, 1, 0, 1, 12, 12, 60000}, sample, pdf);
    EXPECT_TRUE(r.Passes(5)) << parameter << ": " << r.text;
    EXPECT_NEAR(r.pdf_total, 1, 1e-3) << parameter;
  }
}

TEST(Warp2D, InvertUndoesSample) {
  const Warp2D<2> warp = TwoGrids();
  TestRandom random(32);
  for (int n = 0; n < 2000; ++n) {
    const Point2 u = random.Next2<Point2>();
    const Warp2D<2>::Parameters parameters{10 + 10 * random.Next(), 5};
    const WarpPoint there = warp.Sample(u, parameters);
    const WarpPoint back = warp.Invert(there.p, parameters);
    EXPECT_NEAR(there.pdf, warp.Evaluate(there.p, parameters), 1e-3f * there.pdf + 1e-4f);
    EXPECT_NEAR(back.pdf, there.pdf, 1e-3f * there.pdf + 1e-4f);
    if (there.pdf < 0.05f) continue;  // a small error of p is a large one of u
    EXPECT_NEAR(back.p.x, u.x, 1e-3);
    EXPECT_NEAR(back.p.y, u.y, 1e-3);
  }
}

TEST(Warp2D, ParametersAreInterpolatedAndClamped) {
  const Warp2D<3> warp = Warp2D<3>::ForEvaluation(
      {2,
       2,
       {1, 1, 1, 1, 3, 3, 3, 3},
       {std::vector<float>{0}, std::vector<float>{0}, std::vector<float>{400, 500}}});
  EXPECT_EQ(warp.Evaluate({0.3f, 0.6f}, {7, 7, 300}), 1);
  EXPECT_NEAR(warp.Evaluate({0.3f, 0.6f}, {7, 7, 450}), 2, 1e-6);
  EXPECT_EQ(warp.Evaluate({0.3f, 0.6f}, {7, 7, 900}), 3);
}

TEST(Warp2D, GridsOfZerosHaveNoSamples) {
  const Warp2D<0> nothing = Warp2D<0>::ForSampling({2, 2, {0, 0, 0, 0}, {}});
  EXPECT_EQ(nothing.Sample({0.5f, 0.5f}, {}).pdf, 0);
  EXPECT_EQ(nothing.Invert({0.5f, 0.5f}, {}).pdf, 0);
}

void ExpectTheFormula(const MicrofacetDistribution& facets, bool is_isotropic, float tolerance) {
  const MeasuredBrdf brdf = MakeMeasuredBrdf(MeasureMetal(facets, is_isotropic, 48));
  const MeasuredBxdf measured(brdf, {400, 475, 550, 900});
  const float reflectance[] = {0.2f, 0.35f, 0.5f, 0.8f};
  TestRandom random(33);
  for (int n = 0; n < 300; ++n) {
    const Vec3 wo = DirectionOfAngles(1.2f * random.Next(), 2 * kPi * random.Next());
    const Vec3 wi = DirectionOfAngles(1.2f * random.Next(), 2 * kPi * random.Next());
    const Vec3 m = Normalize(wo + wi);
    const float area = (wo.z + facets.Stretch(wo)) / 2;
    const SampledSpectrum f = measured.Evaluate(wo, wi).f;
    for (int i = 0; i < 4; ++i) {
      const float expected = facets.D(m, 1) * reflectance[i] / (4 * area * wi.z);
      EXPECT_NEAR(f[i], expected, tolerance * expected + 1e-3f) << n << " " << i;
    }
  }
}

TEST(Measured, IsotropicMetalAgreesWithItsFormula) {
  ExpectTheFormula({0.4f, 0.4f}, true, 0.02f);
}

TEST(Measured, BrushedMetalAgreesWithItsFormula) {
  ExpectTheFormula({0.35f, 0.6f}, false, 0.05f);
}

TEST(Measured, BackOfTheSurfaceReflectsAsItsFront) {
  const MeasuredBrdf brdf = MakeMeasuredBrdf(MeasureMetal({0.4f, 0.4f}, true, 16));
  const MeasuredBxdf measured(brdf, {400, 475, 550, 900});
  const Vec3 wo = DirectionAt(0.8f, 1), wi = DirectionAt(0.6f, 3);
  EXPECT_EQ(measured.Evaluate(wo, wi).f[0], measured.Evaluate(-wo, -wi).f[0]);
  EXPECT_FALSE(AnyNonZero(measured.Evaluate(wo, -wi).f));
}

}  // namespace
}  // namespace tessera
