#include "renderer/medium/equi_angular.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tessera {
namespace {

constexpr Ray kRay{{1, 2, 3}, {0, 0, 1}};

// Lights before, beside and behind the start of the ray, close to it and far away, of some size and of none.
constexpr BoundingSphere kLights[] = {{{1.1f, 2, 5}, 0},  {{1, 2.01f, 4}, 0}, {{4, 2, 3}, 0},
                                      {{1, 2.5f, 1}, 0},  {{1, 2, 6}, 0.2f},  {{1, 2, 3}, 0.5f},
                                      {{1, 2, -40}, 0.1f}};

// The integral of the density up to t, by Simpson's rule in the logarithm of t.
double Cumulative(const EquiAngular& distances, double t) {
  constexpr int kSteps = 20000;
  constexpr double kFirst = 1e-6;
  const double range = std::log(t / kFirst), step = range / kSteps;
  double sum = static_cast<double>(distances.Pdf(0)) * kFirst;
  for (int i = 0; i <= kSteps; ++i) {
    const double at = kFirst * std::exp(i * step);
    const double weight = i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2;
    sum += weight * step / 3 * at * static_cast<double>(distances.Pdf(static_cast<float>(at)));
  }
  return sum;
}

TEST(EquiAngular, DistancesFollowTheDensity) {
  for (const BoundingSphere& light : kLights) {
    const EquiAngular distances(kRay, light);
    for (const float u : {0.03f, 0.2f, 0.5f, 0.8f, 0.99f}) {
      const auto [t, pdf] = distances.Sample(u);
      ASSERT_GT(t, 0);
      EXPECT_FLOAT_EQ(pdf, distances.Pdf(t));
      // u = 0 is at infinity.
      EXPECT_NEAR(Cumulative(distances, static_cast<double>(t)), 1 - u, 2e-4) << light.center.z << " " << u;
    }
  }
}

TEST(EquiAngular, FalloffWithTheSquareOfTheDistanceCancels) {
  for (const BoundingSphere& light : kLights) {
    if (light.radius > 0) continue;
    const EquiAngular distances(kRay, light);
    const auto product = [&](float t) { return distances.Pdf(t) * LengthSquared(kRay.At(t) - light.center); };
    for (const float t : {0.1f, 0.9f, 2.0f, 3.0f, 50.0f})
      EXPECT_NEAR(product(t) / product(1), 1, 1e-3f) << light.center.x << " " << t;
  }
}

TEST(EquiAngular, DistanceIsThatOfTheNearestPointOfTheRay) {
  EXPECT_FLOAT_EQ(EquiAngular(kRay, {{1.1f, 2, 5}, 0}).distance(), 0.1f);
  EXPECT_FLOAT_EQ(EquiAngular(kRay, {{1, 5, -1}, 0}).distance(), 5);
  EXPECT_FLOAT_EQ(EquiAngular(kRay, {{1, 5, 8}, 4}).distance(), 5);
}

TEST(EquiAngular, RaysThroughALightOfNoSizeHaveFiniteDensities) {
  for (const Point3 center : {Point3{1, 2, 4}, Point3{1, 2, 3}, Point3{1, 2, 2}}) {
    const EquiAngular distances(kRay, {center, 0});
    for (const float u : {0.0f, 0.25f, 0.5f, 0.999f}) {
      const auto [t, pdf] = distances.Sample(u);
      if (center.z == 3) continue;  // the ray starts in the light
      EXPECT_GE(t, 0);
      EXPECT_TRUE(std::isfinite(pdf));
    }
  }
}

}  // namespace
}  // namespace tessera
