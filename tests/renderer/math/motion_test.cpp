#include "renderer/math/motion.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

void ExpectSamePoint(Point3 a, Point3 b, float tolerance = 1e-5f) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Motion, IsExactlyTheEndsAtTheEnds) {
  const Transform a = Translate({1, 2, 3}) * Rotate(20, {1, 2, 3}),
                  b = Scale(2, 3, 4) * Rotate(100, {0, 1, 1});
  EXPECT_TRUE(*Interpolate(a, b, 0) == a);
  EXPECT_TRUE(*Interpolate(a, b, 1) == b);
  EXPECT_TRUE(*Interpolate(a, a, 0.3f) == a);
}

TEST(Motion, TranslationGoesStraight) {
  const auto between = Interpolate(Translate({1, 0, -2}), Translate({3, 8, 2}), 0.25f);
  ExpectSamePoint(between->ToPoint({0, 0, 0}), {1.5f, 2, -1});
}

TEST(Motion, RotationTurnsAtConstantSpeed) {
  for (const float s : {0.25f, 0.5f, 0.9f}) {
    const auto between = Interpolate(Rotate(10, {0, 0, 1}), Rotate(130, {0, 0, 1}), s);
    ExpectSamePoint(between->ToPoint({1, 0, 0}), Rotate(10 + 120 * s, {0, 0, 1}).ToPoint({1, 0, 0}));
  }
}

TEST(Motion, RotationTakesTheShortWay) {
  const auto between = Interpolate(Rotate(350, {0, 1, 0}), Rotate(30, {0, 1, 0}), 0.5f);
  ExpectSamePoint(between->ToPoint({1, 0, 0}), Rotate(10, {0, 1, 0}).ToPoint({1, 0, 0}));
}

TEST(Motion, StretchIsMixedApartFromTheRotation) {
  const auto between = Interpolate(Scale(1, 2, 1), Rotate(90, {0, 0, 1}) * Scale(3, 2, 1), 0.5f);
  ExpectSamePoint(between->ToPoint({1, 0, 0}), Rotate(45, {0, 0, 1}).ToPoint({2, 0, 0}));
}

TEST(Motion, AMirrorImageStaysOne) {
  const auto between = Interpolate(Scale(-1, 1, 1), Scale(-1, 1, 1) * Rotate(90, {1, 0, 0}), 0.5f);
  ASSERT_TRUE(between);
  EXPECT_TRUE(between->SwapsHandedness());
  ExpectSamePoint(between->ToPoint({1, 0, 0}), {-1, 0, 0});
}

TEST(Motion, BetweenMirrorImagesThereIsASingularMap) {
  EXPECT_FALSE(Interpolate(Scale(1, 1, 1), Scale(-1, -1, -1), 0.5f));
}

}  // namespace
}  // namespace tessera
