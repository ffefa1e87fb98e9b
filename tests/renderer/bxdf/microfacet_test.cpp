#include "renderer/bxdf/microfacet.h"

#include <gtest/gtest.h>

#include "tests/chi_square.h"
#include "tests/renderer/bxdf/bxdf_examples.h"

namespace tessera {
namespace {

const MicrofacetDistribution kDistributions[] = {{0.2f, 0.2f}, {1, 1}, {0.15f, 0.6f}};

// The integral of value(m) over the upper hemisphere.
template <typename F>
double IntegrateHemisphere(const F& value) {
  constexpr int kRows = 400, kColumns = 200;
  double sum = 0;
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      const float z = (static_cast<float>(j) + 0.5f) / kRows;
      sum += value(DirectionAt(z, 2 * kPi * (static_cast<float>(i) + 0.5f) / kColumns));
    }
  }
  return sum * 2 * std::numbers::pi / (kRows * kColumns);
}

TEST(Microfacets, ProjectToTheAreaOfTheSurface) {
  for (const MicrofacetDistribution& d : kDistributions) {
    EXPECT_NEAR(IntegrateHemisphere([&](Vec3 m) { return d.D(m, 1) * m.z; }), 1, 0.01);
  }
}

TEST(Microfacets, VisibleNormalsProjectToTheAreaOfTheBeam) {
  for (const MicrofacetDistribution& d : kDistributions) {
    for (const float cos_o : {0.9f, 0.3f}) {
      const Vec3 w = DirectionAt(cos_o, 0.7f);
      const auto visible = [&](Vec3 m) { return d.G1(w) * d.D(m, 1) * std::max(0.0f, Dot(w, m)); };
      EXPECT_NEAR(IntegrateHemisphere(visible), cos_o, 0.01);
    }
  }
}

TEST(Microfacets, DensityDoesNotDependOnTheLengthOfTheHalfVector) {
  const MicrofacetDistribution d(0.15f, 0.6f);
  const Vec3 m = DirectionAt(0.8f, 1);
  EXPECT_NEAR(d.D(m * 3, 9), d.D(m, 1), 1e-4f * d.D(m, 1));
}

TEST(Microfacets, VisibleNormalsMatchTheirDensity) {
  TestRandom random(11);
  for (const MicrofacetDistribution& d : kDistributions) {
    for (const float cos_o : {0.95f, 0.2f, -0.5f}) {
      const Vec3 w = DirectionAt(cos_o, 2);
      const ChiSquareResult r = ChiSquareSphere<Vec3>(
          [&]() -> std::optional<Vec3> { return d.SampleVisibleNormal(w, random.Next2<Point2>()); },
          [&](Vec3 m) {
            if (m.z <= 0) return 0.0f;
            return d.G1(w) * d.D(m, 1) * std::max(0.0f, Dot(w, m) / w.z);
          },
          20, 24, 50000);
      EXPECT_TRUE(r.Passes(9)) << r.text << " cos " << cos_o << " alpha " << d.alpha_x() << " "
                               << d.alpha_y();
    }
  }
}

TEST(Microfacets, ReflectingNormalsSeldomReflectDownwards) {
  TestRandom random(12);
  const MicrofacetDistribution d(0.6f, 0.6f);
  const Vec3 wo = DirectionAt(0.6f, 0);
  int lost = 0, lost_bounded = 0;
  for (int n = 0; n < 10000; ++n) {
    const Point2 u = random.Next2<Point2>();
    lost += Reflect(wo, d.SampleVisibleNormal(wo, u)).z <= 0;
    lost_bounded += Reflect(wo, d.SampleReflectingNormal(wo, u)).z <= 0;
  }
  EXPECT_GT(lost, 500);
  EXPECT_LT(lost_bounded, 0.5 * lost);
}

TEST(Microfacets, SmoothIsDecidedByTheRougherAxis) {
  EXPECT_TRUE(MicrofacetDistribution(0.0009f, 0).IsSmooth());
  EXPECT_FALSE(MicrofacetDistribution(0.001f, 0).IsSmooth());
  EXPECT_EQ(MicrofacetDistribution(0.5f, 0).alpha_y(), MicrofacetDistribution::kAlphaMin);
  EXPECT_FLOAT_EQ(MicrofacetDistribution::AlphaFromRoughness(0.09f), 0.3f);
}

TEST(Microfacets, InvalidValuesOfTexturesAreHarmless) {
  EXPECT_TRUE(MicrofacetDistribution(NAN, -1).IsSmooth());
  EXPECT_EQ(MicrofacetDistribution(INFINITY, NAN).alpha_x(), MicrofacetDistribution::kAlphaMax);
  EXPECT_EQ(MicrofacetDistribution::AlphaFromRoughness(NAN), 0);
}

}  // namespace
}  // namespace tessera
