#include "renderer/shape/curve_budget.h"

#include <gtest/gtest.h>

#include "tests/renderer/shape/curve_examples.h"

namespace tessera {
namespace {

Shape CurvesOf(uint32_t segments, int split_depth) {
  CurveSet curves;
  curves.P.resize(4);
  curves.segments.resize(segments);
  curves.split_depth = static_cast<uint8_t>(split_depth);
  return {{}, std::move(curves)};
}

int DepthOf(const Shape& shape) {
  return std::get<CurveSet>(shape.form).split_depth;
}

TEST(CurveBudget, DeepSplitsOfFewCurvesAreKept) {
  Geometry geometry;
  geometry.shapes.push_back(CurvesOf(kCurvePiecesFloor >> 10, 10));
  EXPECT_EQ(LimitCurvePieces(geometry), std::nullopt);
  EXPECT_EQ(DepthOf(geometry.shapes[0]), 10);
}

TEST(CurveBudget, DeepSplitsOfManyCurvesAreLoweredInTheWorldAndInObjects) {
  Geometry geometry;
  for (int i = 0; i < 5; ++i) geometry.shapes.push_back(CurvesOf(10'000, 10));
  geometry.shapes.push_back(CurvesOf(10'000, 2));
  geometry.groups.resize(1);
  geometry.groups[0].shapes.push_back(CurvesOf(50'000, 9));
  const std::optional<int> depth = LimitCurvePieces(geometry);
  ASSERT_TRUE(depth);
  EXPECT_LE(geometry.PrimitiveCount(), kCurvePiecesFloor);
  EXPECT_GT(geometry.PrimitiveCount(), kCurvePiecesFloor / 2);
  for (size_t i = 0; i < 5; ++i) EXPECT_EQ(DepthOf(geometry.shapes[i]), *depth);
  EXPECT_EQ(DepthOf(geometry.shapes[5]), 2);
  EXPECT_EQ(DepthOf(geometry.groups[0].shapes[0]), *depth);
}

TEST(CurveBudget, TheDefaultDepthIsKeptForAnyNumberOfCurves) {
  Geometry geometry;
  for (int i = 0; i < 4; ++i) geometry.shapes.push_back(CurvesOf(500'000, 3));
  EXPECT_EQ(LimitCurvePieces(geometry), std::nullopt);
  geometry.shapes.push_back(CurvesOf(500'000, 4));
  EXPECT_EQ(LimitCurvePieces(geometry), 3);
  EXPECT_EQ(DepthOf(geometry.shapes[4]), 3);
}

TEST(CurveBudget, AHullHoldsAllPiecesOfItsCurves) {
  TestRandom random(1);
  for (int kind = 0; kind < 12; ++kind) {
    const CurveSet curves = RandomCurve(random, kind, {1, 2, 3}, 2, 0.3f);
    const Bounds3 hull = curves.HullBounds(), pieces = Shape{{}, curves}.Bounds();
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(hull.min[axis], pieces.min[axis]);
      EXPECT_GE(hull.max[axis], pieces.max[axis]);
    }
  }
}

}  // namespace
}  // namespace tessera
