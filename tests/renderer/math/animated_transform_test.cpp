#include "renderer/math/animated_transform.h"

#include <gtest/gtest.h>

#include "renderer/math/motion.h"

namespace tessera {
namespace {

AnimatedTransform MovingAlongX(std::vector<std::pair<double, float>> keys) {
  std::vector<TransformKey> list;
  for (const auto& [time_s, x] : keys) list.push_back({time_s, Translate({x, 0, 0})});
  return AnimatedTransform(std::move(list));
}

float XAt(const AnimatedTransform& transform, double time_s) {
  return transform.At(time_s)->ToPoint({0, 0, 0}).x;
}

TEST(AnimatedTransform, OfOneTransformIsFixed) {
  const AnimatedTransform fixed(Translate({1, 2, 3}));
  EXPECT_FALSE(fixed.IsAnimated());
  EXPECT_EQ(*fixed.At(7), Translate({1, 2, 3}));
  EXPECT_EQ(fixed.Fixed(), Translate({1, 2, 3}));
  EXPECT_EQ(fixed.bytes(), 0u);
}

TEST(AnimatedTransform, OfEqualKeysIsFixed) {
  EXPECT_FALSE(MovingAlongX({{0, 4}, {1, 4}, {2, 4}}).IsAnimated());
  EXPECT_TRUE(MovingAlongX({{0, 4}, {1, 5}, {2, 4}}).IsAnimated());
}

TEST(AnimatedTransform, InterpolatesBetweenTheKeysAroundATime) {
  const AnimatedTransform transform = MovingAlongX({{1, 0}, {2, 10}, {4, 30}, {5, 30}});
  EXPECT_FLOAT_EQ(XAt(transform, 1.5), 5);
  EXPECT_FLOAT_EQ(XAt(transform, 2), 10);
  EXPECT_FLOAT_EQ(XAt(transform, 2.5), 15);
  EXPECT_FLOAT_EQ(XAt(transform, 4.5), 30);
}

TEST(AnimatedTransform, RestsBeforeTheFirstAndAfterTheLastKey) {
  const AnimatedTransform transform = MovingAlongX({{1, 3}, {2, 10}});
  EXPECT_EQ(XAt(transform, -5), 3);
  EXPECT_EQ(XAt(transform, 1), 3);
  EXPECT_EQ(XAt(transform, 2), 10);
  EXPECT_EQ(XAt(transform, 99), 10);
}

TEST(AnimatedTransform, JumpsAtTwoKeysOfEqualTime) {
  const AnimatedTransform transform = MovingAlongX({{1, 3}, {1, 10}});
  EXPECT_EQ(XAt(transform, 1), 3);
  EXPECT_EQ(XAt(transform, 1.001), 10);
}

TEST(AnimatedTransform, OfTwoKeysIsInterpolatedToTheBit) {
  const Transform start = Rotate(20, {0, 1, 0}) * Scale(1, 2, 3), end = Translate({1, 2, 3});
  const AnimatedTransform transform({{0, start}, {0.5, end}});
  EXPECT_EQ(*transform.At(0.2), *Interpolate(start, end, 0.4f));
}

TEST(AnimatedTransform, HasNoValueWhereTheMapIsSingular) {
  const AnimatedTransform transform({{0, Scale(1, 1, 1)}, {1, Scale(-1, 1, 1)}});
  EXPECT_FALSE(transform.At(0.5));
  EXPECT_TRUE(transform.At(1));
}

TEST(AnimatedTransform, InvertsEachKey) {
  const AnimatedTransform inverse = MovingAlongX({{1, 3}, {2, 10}}).Inverse();
  EXPECT_EQ(XAt(inverse, 1), -3);
  EXPECT_EQ(XAt(inverse, 2), -10);
}

}  // namespace
}  // namespace tessera
