// What a ray sees of a curve: area, parameters, normals.
#include <gtest/gtest.h>

#include "tests/renderer/shape/curve_examples.h"

namespace tessera {
namespace {

using CurveType = CurveSet::Type;

// The share of a square of half size `half` in the plane z = 0, times its area, that parallel rays along
// `d` hit.
double CoveredArea(const CurveSet& curves, double half, Vec3 d, int side) {
  int hits = 0;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const Double3 target(half * (2 * (i + 0.5) / side - 1), half * (2 * (j + 0.5) / side - 1), 0);
      Crossing crossing;
      hits += IntersectAll(curves, {target - Double3(d) * 10, Double3(d)}, &crossing);
    }
  }
  return 4 * half * half * hits / (double{1} * side * side);
}

double LengthOf(const CurveSet& curves) {
  double length = 0;
  for (uint32_t s = 0; s < curves.segments.size(); ++s) {
    const CurvePolynomial curve = curves.Polynomial(s, {});
    constexpr int kSteps = 1000;
    for (int i = 0; i < kSteps; ++i) {
      const Double3 speed = curve.Derivative((i + 0.5) / kSteps);
      length += std::sqrt(Dot(speed, speed)) / kSteps;
    }
  }
  return length;
}

TEST(CurveSurface, CoversItsLengthTimesItsWidth) {
  // In the plane z = 0, bent gently: the band beside the axis does not overlap itself.
  const std::vector<Point3> P{{-0.9f, -0.5f, 0}, {-0.3f, 0.8f, 0}, {0.3f, -0.8f, 0}, {0.9f, 0.5f, 0}};
  for (const CurveType type : {CurveType::kFlat, CurveType::kCylinder}) {
    const CurveSet curve = MakeCurve(type, CurveBasis::kBezier, 3, P, 0.12f, 0.12f);
    const double expected = LengthOf(curve) * 0.12;
    EXPECT_NEAR(CoveredArea(curve, 1, {0, 0, 1}, 700), expected, 0.004 * expected);
  }
  const CurveSet tapered = StraightCurve(CurveType::kFlat, {-0.8f, -0.4f, 0}, {0.8f, 0.5f, 0}, 0.3f, 0.1f);
  const double expected = LengthOf(tapered) * 0.2;
  EXPECT_NEAR(CoveredArea(tapered, 1, {0, 0, 1}, 700), expected, 0.004 * expected);
}

TEST(CurveSurface, ARibbonIsSeenInProportionToTheCosineOfItsNormal) {
  CurveSet ribbon = StraightCurve(CurveType::kRibbon, {-0.8f, 0, 0}, {0.8f, 0, 0}, 0.3f, 0.3f);
  for (const float degrees : {0.0f, 30.0f, 60.0f, 80.0f}) {
    const float angle = Radians(degrees);
    ribbon.N = {{0, std::sin(angle), std::cos(angle)}, {0, std::sin(angle), std::cos(angle)}};
    const double expected = 1.6 * 0.3 * std::cos(angle);
    EXPECT_NEAR(CoveredArea(ribbon, 1, {0, 0, 1}, 700), expected, 0.01) << degrees;
  }
  ribbon.N = {{0, 1, 0}, {0, 1, 0}};
  EXPECT_EQ(CoveredArea(ribbon, 1, {0, 0, 1}, 100), 0);
}

TEST(CurveSurface, TheNormalOfARibbonTurnsAlongAGreatCircle) {
  CurveSet ribbon = StraightCurve(CurveType::kRibbon, {0, 0, 0}, {1, 0, 0}, 1, 1);
  ribbon.N = {{0, 0, 1}, {0, 1, 0}};
  const Normal3 middle = ribbon.RibbonNormal(0, 1.0 / 3);
  EXPECT_NEAR(middle.y, 0.5, 1e-6);
  EXPECT_NEAR(middle.z, std::sqrt(0.75), 1e-6);
  ribbon.N = {{0, 0, 1}, {0, 0, 1}};
  EXPECT_EQ(ribbon.RibbonNormal(0, 0.7), (Normal3{0, 0, 1}));
  ribbon.N = {{0, 0, 1}, {0, 0, -1}};  // opposite: finite
  EXPECT_TRUE(IsFinite(ribbon.RibbonNormal(0, 0.5)));
}

TEST(CurveSurface, UIsAlongTheSegmentAndVAcrossFromRightToLeft) {
  const CurveSet curve = StraightCurve(CurveType::kFlat, {-1, 0, 5}, {1, 0, 5}, 0.4f, 0.4f);
  // The ray looks along +z with y up: x runs to the left, as z is away from the viewer.
  for (const float x : {-0.7f, 0.1f, 0.8f}) {
    for (const float y : {-0.19f, -0.05f, 0.12f}) {
      Crossing crossing;
      ASSERT_TRUE(IntersectAll(curve, {{x, y, 0}, {0, 0, 2}}, &crossing));
      EXPECT_NEAR(crossing.t, 2.5, 1e-9);
      EXPECT_NEAR(crossing.u, (x + 1) / 2, 1e-6);
      EXPECT_NEAR(crossing.v, 0.5f + y / 0.4f, 1e-5);
    }
  }
}

SurfaceInteraction CurveInteraction(const CurveSet& curves, const Ray& ray) {
  SurfaceInteraction interaction;
  Hit hit;
  Crossing nearest;
  nearest.t = kNoEnd;
  for (uint32_t i = 0; i < curves.PrimitiveCount(); ++i) {
    Crossing crossing;
    if (!curves.Intersect(i, {Double3(ray.o), Double3(ray.d)}, kNoEnd, &crossing)) continue;
    if (crossing.t >= nearest.t) continue;
    nearest = crossing;
    hit = {static_cast<float>(crossing.t), crossing.u, crossing.v, 0, i};
  }
  EXPECT_LT(nearest.t, kNoEnd);
  curves.FillInteraction(hit, {ray}, &interaction);
  return interaction;
}

TEST(CurveSurface, FlatCurvesFaceTheRayAndCylindersTurnWithV) {
  for (const CurveType type : {CurveType::kFlat, CurveType::kCylinder}) {
    const CurveSet curve = StraightCurve(type, {-1, 0, 5}, {1, 0, 5}, 0.4f, 0.4f);
    for (const float y : {-0.15f, 0.0f, 0.1f}) {
      const SurfaceInteraction at = CurveInteraction(curve, {{0.2f, y, 0}, {0, 0, 1}});
      const float theta = type == CurveType::kFlat ? 0 : y / 0.4f * kPi;
      EXPECT_NEAR(at.p.x, 0.2f, 1e-6);
      EXPECT_NEAR(at.p.y, y, 1e-6);
      EXPECT_NEAR(at.p.z, 5, 1e-6);
      EXPECT_NEAR(at.dpdu.x, 2, 1e-5);
      EXPECT_NEAR(at.n.y, std::sin(theta), 1e-5);
      EXPECT_NEAR(at.n.z, std::cos(theta), 1e-5);
      EXPECT_NEAR(at.dpdv.y, 0.4f * std::cos(theta), 1e-5);
      EXPECT_NEAR(at.dpdv.z, -0.4f * std::sin(theta), 1e-5);
      EXPECT_EQ(at.p_error, (Vec3{0.4f, 0.4f, 0.4f}));
    }
  }
}

TEST(CurveSurface, ReversedOrientationTurnsTheNormal) {
  CurveSet curve = StraightCurve(CurveType::kFlat, {-1, 0, 5}, {1, 0, 5}, 0.4f, 0.4f);
  curve.flip_normals = true;
  EXPECT_NEAR(CurveInteraction(curve, {{0, 0, 0}, {0, 0, 1}}).n.z, -1, 1e-6);
}

TEST(CurveSurface, ATransformIsThatOfTheRay) {
  TestRandom random(24);
  for (int c = 0; c < 12; ++c) {
    const CurveSet plain = RandomCurve(random, c, {}, 3, 0.8f);
    CurveSet placed = plain;
    const Transform transform = RandomTransform(random, 4);
    placed.render_from_object = std::make_shared<const Transform>(transform);
    int hits = 0;
    for (int i = 0; i < 1000; ++i) {
      const Ray ray{transform.ToPoint(RandomPoint(random, 9)), {}};
      const Ray to{ray.o, transform.ToPoint(RandomPoint(random, 2)) - ray.o};
      const DoubleRay exact{Double3(to.o), Double3(to.d)};
      Crossing a, b;
      const bool in_object_space = IntersectAll(plain, exact.TransformedBy(transform.inverse_matrix()), &a);
      ASSERT_EQ(IntersectAll(placed, exact, &b), in_object_space);
      if (!in_object_space) continue;
      ++hits;
      EXPECT_EQ(a.t, b.t);
      const SurfaceInteraction at = CurveInteraction(placed, to);
      EXPECT_LT(Distance(at.p, exact.At(b.t).ToFloat()), 1e-4f);
      EXPECT_NEAR(Length(at.n), 1, 1e-5);
      EXPECT_NEAR(Dot(at.n, Normalize(at.dpdu)), 0, 1e-4);
      EXPECT_NEAR(Dot(at.n, Normalize(at.dpdv)), 0, 1e-4);
    }
    EXPECT_GT(hits, 10);
  }
}

TEST(CurveSurface, RaysThatLeaveACurveStartOutsideIt) {
  TestRandom random(26);
  for (const CurveType type : {CurveType::kFlat, CurveType::kCylinder}) {
    const CurveSet curve = StraightCurve(type, {-1, -2, 5}, {1, 1, 6}, 0.1f, 0.1f);
    int hits = 0;
    for (int i = 0; i < 4000; ++i) {
      const Ray ray{RandomPoint(random, 3), {}};
      const Ray to{ray.o, Lerp(random.Next(), {-1, -2, 5}, {1, 1, 6}) + RandomPoint(random, 0.03f) - ray.o};
      Crossing crossing;
      if (!IntersectAll(curve, {Double3(to.o), Double3(to.d)}, &crossing)) continue;
      ++hits;
      const SurfaceInteraction at = CurveInteraction(curve, to);
      const Vec3 out = FaceForward(RandomDirection(random), at.n);
      const Ray next = at.SpawnRay(out);
      EXPECT_FALSE(IntersectAll(curve, {Double3(next.o), Double3(next.d)}, &crossing));
    }
    EXPECT_GT(hits, 1000);
  }
}

TEST(CurveSurface, DegenerateCurvesAreMissedOrHaveFiniteGeometry) {
  TestRandom random(25);
  const Point3 a{0, 0, 3}, b{1, 0, 3};
  const std::vector<std::vector<Point3>> control = {{a, a, a, a},
                                                    {a, a, b, b},
                                                    {a, b, b, b},
                                                    {a, a, a, b},
                                                    {a, b, a, b},
                                                    {a, b, b, a},
                                                    {a, {0, 0, 4}, {0, 0, 5}, {0, 0, 6}}};
  for (const std::vector<Point3>& P : control) {
    for (const CurveType type : {CurveType::kFlat, CurveType::kRibbon, CurveType::kCylinder}) {
      for (const float width : {0.0f, 1e-30f, 0.5f}) {
        const CurveSet curve = MakeCurve(type, CurveBasis::kBezier, 3, P, width, 0.5f);
        for (int i = 0; i < 300; ++i) {
          // Some along the curve, some along axes.
          Ray ray{RandomPoint(random, 1), {}};
          ray.d = i % 5 == 0 ? Vec3{0, 0, 1} : i % 5 == 1 ? b - a : RandomPoint(random, 1) + a - ray.o;
          if (i % 10 == 0) ray.o = {0, 0, 0};
          if (i % 10 == 1) ray.o = a - Vec3{2, 0, 0};
          for (uint32_t piece = 0; piece < curve.PrimitiveCount(); ++piece) {
            Crossing crossing;
            if (!curve.Intersect(piece, {Double3(ray.o), Double3(ray.d)}, kNoEnd, &crossing)) continue;
            ASSERT_TRUE(std::isfinite(crossing.t) && crossing.t > 0);
            ASSERT_TRUE(crossing.u >= 0 && crossing.u <= 1 && crossing.v >= 0 && crossing.v <= 1);
            SurfaceInteraction at;
            curve.FillInteraction({static_cast<float>(crossing.t), crossing.u, crossing.v, 0, piece}, {ray},
                                  &at);
            ASSERT_TRUE(IsFinite(at.p) && IsFinite(at.n) && IsFinite(at.dpdu) && IsFinite(at.dpdv));
            ASSERT_NEAR(Length(at.n), 1, 1e-4);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace tessera
