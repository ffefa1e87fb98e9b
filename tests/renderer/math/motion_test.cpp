#include "renderer/math/motion.h"

#include <gtest/gtest.h>

#include "renderer/math/flat_transform.h"
#include "renderer/math/random_stream.h"

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

Vec3 RandomVector(RandomStream& random, float size) {
  const float x = random.Next(), y = random.Next(), z = random.Next();
  return {(2 * x - 1) * size, (2 * y - 1) * size, (2 * z - 1) * size};
}

// Of any rotation; some mirror, some are flat.
Transform RandomMap(RandomStream& random, int kind) {
  const float sign = kind % 4 == 1 ? -1.0f : 1.0f;
  const Transform stretch =
      Scale(sign * (0.2f + 2 * random.Next()), 0.2f + 2 * random.Next(), 0.2f + 2 * random.Next());
  const Transform shear = Rotate(360 * random.Next(), RandomVector(random, 1));
  const Transform turn = Rotate(kind % 4 == 2 ? 1.0f : 360 * random.Next(), RandomVector(random, 1));
  const Transform map = Translate(RandomVector(random, 10)) * turn * stretch * shear;
  return kind % 8 == 3 ? Transform(map.matrix(), ZeroMatrix()) : map;
}

TEST(Motion, BoundsHoldThePointsOfABoxAtAllTimesAndLittleMore) {
  RandomStream random(1);
  for (int kind = 0; kind < 400; ++kind) {
    const Transform start = RandomMap(random, kind), end = RandomMap(random, kind / 3);
    const TransformPath path(start, end);
    Bounds3 box;
    box.Add(RandomVector(random, 3));
    box.Add(RandomVector(random, 3));
    const float from = kind % 5 == 0 ? 0.0f : 0.8f * random.Next(), to = kind % 7 == 0 ? 1.0f : from + 0.2f;
    const Bounds3 bounds = path.BoundsOf(box, from, to);
    Bounds3 reached;
    for (int i = 0; i <= 500; ++i) {
      const auto map = path.At(from + (to - from) * static_cast<float>(i) / 500);
      if (map) reached.Add(map->ToBounds(box));
    }
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_LE(bounds.min[axis], reached.min[axis]) << kind;
      ASSERT_GE(bounds.max[axis], reached.max[axis]) << kind;
    }
    EXPECT_LT(Length(bounds.Diagonal()), 1.02f * Length(reached.Diagonal()) + 1e-3f) << kind;
  }
}

TEST(Motion, BoundsOfATurnHoldTheArcBetweenItsEnds) {
  // A point at (1, 0, 0) turns by a half: it comes by (0, 1, 0), which no end shows.
  const TransformPath path(Transform(), Rotate(179.9f, {0, 0, 1}));
  const Bounds3 bounds = path.BoundsOf({{1, 0, 0}, {1, 0, 0}}, 0, 1);
  EXPECT_GE(bounds.max.y, 1);
  EXPECT_LT(bounds.max.y, 1.002f);
  EXPECT_LE(bounds.min.x, -0.99f);
}

}  // namespace
}  // namespace tessera
