// From Shape "curve" to sets of curves: parameters, defaults, warnings and errors.
#include <gmock/gmock.h>

#include "tests/renderer/shape/built_shape.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const std::string kCubic = "Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 2 1 0 3 1 0] ";

TEST(CurveReader, CurvesHavePbrtsDefaults) {
  const Built built = Build(kCubic);
  const CurveSet& curve = Only<CurveSet>(built);
  EXPECT_EQ(curve.type, CurveSet::Type::kFlat);
  EXPECT_EQ(curve.basis, CurveBasis::kBezier);
  EXPECT_EQ(curve.degree, 3);
  EXPECT_EQ(curve.split_depth, 3);
  EXPECT_EQ(curve.PrimitiveCount(), 8u);
  ASSERT_EQ(curve.segments.size(), 1u);
  EXPECT_EQ(curve.segments[0].width0, 1);
  EXPECT_EQ(curve.segments[0].width1, 1);
  EXPECT_EQ(curve.render_from_object, nullptr);
  EXPECT_THAT(built.diagnostics.WarningTexts(), IsEmpty());
}

TEST(CurveReader, WidthsAreLinearAlongTheWholeCurve) {
  const Built built = Build(
      "Shape \"curve\" \"string basis\" \"bspline\" \"point3 P\" [0 0 0 1 0 0 2 1 0 3 1 0 4 1 0]\n"
      "\"float width\" 3 \"float width1\" 1 \"string type\" \"cylinder\" \"integer splitdepth\" 0");
  const CurveSet& curve = Only<CurveSet>(built);
  EXPECT_EQ(curve.type, CurveSet::Type::kCylinder);
  ASSERT_EQ(curve.segments.size(), 2u);
  EXPECT_EQ(curve.PrimitiveCount(), 2u);
  EXPECT_EQ(curve.segments[0].width0, 3);
  EXPECT_EQ(curve.segments[0].width1, 2);
  EXPECT_EQ(curve.segments[1].first_point, 1u);
  EXPECT_EQ(curve.segments[1].width0, 2);
  EXPECT_EQ(curve.segments[1].width1, 1);
}

TEST(CurveReader, BezierSegmentsShareTheirEndPoints) {
  const Built built =
      Build("Shape \"curve\" \"integer degree\" 2 \"point3 P\" [0 0 0 1 0 0 2 1 0 3 1 0 4 1 0]");
  const CurveSet& curve = Only<CurveSet>(built);
  ASSERT_EQ(curve.segments.size(), 2u);
  EXPECT_EQ(curve.segments[1].first_point, 2u);
  EXPECT_EQ(curve.P.size(), 5u);
}

TEST(CurveReader, MapsThatKeepAnglesMoveThePointsOthersMoveTheRays) {
  const Built moved = Build("Translate 1 2 3 Rotate 90 0 0 1 Scale 2 2 2 " + kCubic);
  const CurveSet& curve = Only<CurveSet>(moved);
  EXPECT_EQ(curve.render_from_object, nullptr);
  EXPECT_FLOAT_EQ(curve.segments[0].width0, 2);
  EXPECT_NEAR(curve.P[1].y, 4, 1e-6);
  for (const std::string map : {"Scale 1 2 1 ", "Scale -1 1 1 "}) {
    const Built stretched = Build(map + kCubic);
    EXPECT_NE(Only<CurveSet>(stretched).render_from_object, nullptr) << map;
    EXPECT_EQ(Only<CurveSet>(stretched).P[1], (Point3{1, 0, 0}));
  }
  EXPECT_TRUE(Only<CurveSet>(Build("Scale -1 1 1 " + kCubic)).flip_normals);
}

TEST(CurveReader, RibbonsHaveUnitNormalsAtTheEndsOfTheirSegments) {
  const Built built =
      Build("Scale 2 2 2 " + kCubic + "\"string type\" \"ribbon\" \"normal N\" [0 0 4 0 3 0]");
  EXPECT_THAT(Only<CurveSet>(built).N, ElementsAre(Normal3{0, 0, 1}, Normal3{0, 1, 0}));
}

TEST(CurveReader, WhatPbrtOnlyComplainsAboutIsAWarning) {
  const Built odd = Build(kCubic + "\"string type\" \"round\" \"normal N\" [0 0 1 0 0 1]");
  EXPECT_EQ(Only<CurveSet>(odd).type, CurveSet::Type::kCylinder);
  EXPECT_THAT(odd.diagnostics.WarningTexts(),
              ElementsAre("a.pbrt:2:52: unknown type \"round\" of curve, expected one of flat, ribbon, "
                          "cylinder; it is rendered as \"cylinder\"",
                          "a.pbrt:2:74: \"N\" is ignored: only curves of type \"ribbon\" have normals"));
  const Built thin = Build(kCubic + "\"float width\" 0");
  EXPECT_THAT(thin.shapes, IsEmpty());
  EXPECT_THAT(thin.diagnostics.WarningTexts(),
              ElementsAre("a.pbrt:2:1: the curve is not shown: its width is 0"));
  const Built flat = Build("Scale 1 0 1 " + kCubic);
  EXPECT_THAT(flat.shapes, IsEmpty());
  EXPECT_THAT(flat.diagnostics.WarningTexts(),
              ElementsAre("a.pbrt:2:13: the shape is not shown: its transformation has no inverse"));
}

TEST(CurveReader, ErrorsNameTheProblemAndItsLocation) {
  EXPECT_EQ(Build("Shape \"curve\" \"point3 P\" [0 0 0]").error,
            "a.pbrt:2:15: a Bezier curve of degree 3 needs 4 + n * 3 control points, got 1");
  EXPECT_EQ(Build("Shape \"curve\"").error,
            "a.pbrt:2:1: a Bezier curve of degree 3 needs 4 + n * 3 control points, got 0");
  EXPECT_EQ(Build(kCubic + "\"integer degree\" 2").error,
            "a.pbrt:2:15: a Bezier curve of degree 2 needs 3 + n * 2 control points, got 4");
  EXPECT_EQ(Build("Shape \"curve\" \"string basis\" \"bspline\" \"point3 P\" [0 0 0 1 1 1]").error,
            "a.pbrt:2:40: a B-spline of degree 3 needs at least 4 control points, got 2");
  EXPECT_EQ(Build(kCubic + "\"integer degree\" 4").error, "a.pbrt:2:52: degree must be 2 or 3");
  EXPECT_EQ(Build(kCubic + "\"float width1\" -1").error, "a.pbrt:2:52: width1 must not be negative");
  EXPECT_EQ(Build(kCubic + "\"string type\" \"ribbon\"").error,
            "a.pbrt:2:1: a ribbon of 1 segments needs 2 normals \"N\", got 0");
  EXPECT_EQ(Build(kCubic + "\"string type\" \"ribbon\" \"normal N\" [0 0 0 0 0 1]").error,
            "a.pbrt:2:75: a normal of a ribbon is zero");
  EXPECT_EQ(Build("Scale 1e30 1e30 1e30 Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 2e9 1 0 3 1 0]").error,
            "a.pbrt:2:22: the shape is not within +-1e+17 in rendering space");
  for (const std::string number : {"nan", "inf", "1e39"}) {
    EXPECT_THAT(Build("Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 2 1 0 3 1 " + number + "]").error,
                testing::StartsWith("a.pbrt:2:"))
        << number;
  }
  EXPECT_THAT(Build(kCubic + "\"string basis\" \"hermite\"").error, testing::StartsWith("a.pbrt:2:52: "));
}

TEST(CurveReader, CurvesOfOneSurfaceAreStoredTogether) {
  Built first = Build(kCubic), second = Build(kCubic), transparent = Build(kCubic + "\"float alpha\" 0.5");
  EXPECT_FALSE(MergeCurves(transparent.shapes[0], &first.shapes[0]));
  EXPECT_FALSE(MergeCurves(Build("Shape \"sphere\"").shapes[0], &first.shapes[0]));
  EXPECT_EQ(Only<CurveSet>(first).segments.size(), 1u);
  EXPECT_TRUE(MergeCurves(second.shapes[0], &first.shapes[0]));
  EXPECT_EQ(Only<CurveSet>(first).segments.size(), 2u);
  EXPECT_EQ(Only<CurveSet>(first).segments[1].first_point, 4u);
}

}  // namespace
}  // namespace tessera
