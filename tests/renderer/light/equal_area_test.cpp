#include "renderer/math/equal_area.h"

#include <gtest/gtest.h>

#include "renderer/math/sampling.h"
#include "tests/chi_square.h"

namespace tessera {
namespace {

TEST(EqualArea, MappingToTheSquareAndBackReturnsTheDirection) {
  TestRandom random(1);
  for (int i = 0; i < 100000; ++i) {
    const Vec3 d = SampleUniformSphere(random.Next2<Point2>());
    const Point2 p = EqualAreaSphereToSquare(d);
    ASSERT_TRUE(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1);
    ASSERT_LT(Distance(EqualAreaSquareToSphere(p), d), 3e-6f) << d.x << " " << d.y << " " << d.z;
  }
}

TEST(EqualArea, DirectionsAreUnitVectors) {
  for (int y = 0; y <= 64; ++y) {
    for (int x = 0; x <= 64; ++x) {
      const Vec3 d = EqualAreaSquareToSphere({static_cast<float>(x) / 64, static_cast<float>(y) / 64});
      ASSERT_NEAR(Length(d), 1, 1e-6f);
    }
  }
}

// The solid angle of the quadrilateral between four directions, as two spherical triangles (van Oosterom and
// Strackee 1983).
double SolidAngle(Vec3 a, Vec3 b, Vec3 c) {
  const double volume = std::abs(static_cast<double>(Dot(a, Cross(b, c))));
  const double side = 1.0 + static_cast<double>(Dot(a, b)) + Dot(b, c) + Dot(c, a);
  return 2 * std::atan2(volume, side);
}

TEST(EqualArea, EqualAreasAreEqualSolidAngles) {
  // Cells are subdivided because their edges are curved.
  constexpr int kCells = 16, kParts = 8;
  const auto corner = [](int x, int y) {
    return EqualAreaSquareToSphere(
        {static_cast<float>(x) / (kCells * kParts), static_cast<float>(y) / (kCells * kParts)});
  };
  std::vector<double> areas(kCells * kCells, 0.0);
  for (int y = 0; y < kCells * kParts; ++y) {
    for (int x = 0; x < kCells * kParts; ++x) {
      const Vec3 a = corner(x, y), b = corner(x + 1, y), c = corner(x + 1, y + 1), d = corner(x, y + 1);
      // Both diagonals: the mean corrects for curved edges to first order.
      areas[static_cast<size_t>(y / kParts * kCells + x / kParts)] +=
          (SolidAngle(a, b, c) + SolidAngle(a, c, d) + SolidAngle(a, b, d) + SolidAngle(b, c, d)) / 2;
    }
  }
  for (const double area : areas) EXPECT_NEAR(area * kCells * kCells / (4 * kPi), 1, 0.01);
}

TEST(EqualArea, UniformPointsMapToUniformDirections) {
  TestRandom random(2);
  const ChiSquareResult r = ChiSquareSphere<Vec3>(
      [&]() -> std::optional<Vec3> { return EqualAreaSquareToSphere(random.Next2<Point2>()); },
      [](Vec3) { return UniformSpherePdf(); });
  EXPECT_TRUE(r.Passes()) << r.text;
}

TEST(EqualArea, HasTheOrientationOfEnvironmentMaps) {
  const auto expect = [](Point2 p, Vec3 d) { EXPECT_LT(Distance(EqualAreaSquareToSphere(p), d), 1e-6f); };
  expect({0.5f, 0.5f}, {0, 0, 1});
  expect({0, 0}, {0, 0, -1});
  expect({1, 1}, {0, 0, -1});
  expect({1, 0.5f}, {1, 0, 0});
  expect({0.5f, 1}, {0, 1, 0});
  expect({0, 0.5f}, {-1, 0, 0});
}

}  // namespace
}  // namespace tessera
