#include "renderer/math/moving_transform.h"

#include <gtest/gtest.h>

#include "renderer/math/flat_transform.h"

namespace tessera {
namespace {

MovingTransform Moving(const AnimatedTransform& transform) {
  return MovingTransform(std::span(&transform, 1));
}

AnimatedTransform TurnAndBack() {
  return AnimatedTransform({{1, Translate({1, 0, 0})},
                            {2, Rotate(80, {0, 1, 0}) * Scale(2, 1, 1)},
                            {2, Translate({0, 5, 0})},
                            {4, Rotate(-70, {1, 1, 0})}});
}

void ExpectMap(const Transform& map, const Matrix4& matrix) {
  EXPECT_EQ(map.matrix(), matrix);
  EXPECT_EQ(map.inverse_matrix(), *AffineInverse(matrix));
}

TEST(MovingTransform, HasTheMatrixOfTheAnimatedOneAtAnyTimeAndItsInverse) {
  const AnimatedTransform animated = TurnAndBack();
  const MovingTransform moving = Moving(animated);
  for (const float time : {-3.f, 1.f, 1.25f, 2.f, 2.01f, 3.75f, 4.f, 9.f})
    ExpectMap(moving.At(time), animated.At(time)->matrix());
}

TEST(MovingTransform, OfSeveralFactorsIsTheirProduct) {
  const AnimatedTransform factors[] = {AnimatedTransform(Translate({3, 2, 1})), AnimatedTransform(),
                                       TurnAndBack(),
                                       AnimatedTransform({{0, Transform()}, {8, Scale(3, 1, 1)}})};
  const MovingTransform moving(factors);
  for (const float time : {0.f, 1.5f, 3.f}) {
    const Transform product = factors[0].First() * *factors[2].At(time) * *factors[3].At(time);
    ExpectMap(moving.At(time), product.matrix());
  }
}

TEST(MovingTransform, BoundsHoldAllTimesBetweenTwoAndNoOthers) {
  const AnimatedTransform factors[] = {TurnAndBack(), TurnAndBack()};
  const MovingTransform moving(factors);
  const Bounds3 box{{-1, 0, 0}, {1, 0.5f, 2}};
  for (const auto& [from, to] : {std::pair{-1.f, 9.f}, {0.f, 1.5f}, {1.9f, 2.1f}, {2.5f, 2.5f}, {5.f, 6.f}}) {
    const Bounds3 bounds = moving.BoundsOf(box, from, to);
    for (int i = 0; i <= 300; ++i) {
      const Bounds3 then = moving.At(from + (to - from) * static_cast<float>(i) / 300).ToBounds(box);
      ASSERT_TRUE(bounds.Contains(then.min) && bounds.Contains(then.max)) << from << " " << to << " " << i;
    }
  }
  EXPECT_LT(Length(moving.BoundsOf(box, 5, 6).Diagonal()),
            0.7f * Length(moving.BoundsOf(box, 0, 6).Diagonal()));
}

TEST(MovingTransform, IsFlatWhereTheMapIsSingular) {
  const MovingTransform moving = Moving(AnimatedTransform({{0, Scale(1, 1, 1)}, {1, Scale(-1, 1, 1)}}));
  EXPECT_TRUE(IsFlat(moving.At(0.5f)));
  EXPECT_FALSE(IsFlat(moving.At(0.75f)));
}

}  // namespace
}  // namespace tessera
