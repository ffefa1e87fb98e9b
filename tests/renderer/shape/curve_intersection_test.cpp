// Rays against curves: brute force, pieces, bounds.
#include <gtest/gtest.h>

#include "renderer/shape/curve_intersection.h"
#include "tests/renderer/shape/curve_examples.h"

namespace tessera {
namespace {

DoubleRay RayTo(Point3 from, Point3 to) {
  return {Double3(from), Double3(to - from)};
}

// The offset of the curve from the ray, at right angles to the ray, and the slope of its squared length.
struct Offset {
  double distance, slope, t;
};
Offset OffsetAt(const CurvePolynomial& curve, const DoubleRay& ray, double u) {
  const Double3 p = curve.At(u) - ray.o, dp = curve.Derivative(u);
  const double t = Dot(p, ray.d) / Dot(ray.d, ray.d);
  const Double3 across = p - ray.d * t;
  return {std::sqrt(Dot(across, across)), Dot(across, dp), t};
}

struct BruteHit {
  bool found = false;
  double t = kNoEnd, u = 0;
  // How close the decision was: the least |distance - half width| of a minimum, or |u| outside [0, 1].
  double margin = kNoEnd;
};

// Looks for minima of the distance in 2,000 steps per segment, and bisects each.
BruteHit BruteForce(const CurveSet& curves, const DoubleRay& ray) {
  constexpr int kSteps = 2000;
  BruteHit best;
  const Double3 unit = ray.d * (1 / std::sqrt(Dot(ray.d, ray.d)));
  for (uint32_t s = 0; s < curves.segments.size(); ++s) {
    const CurvePolynomial curve = curves.Polynomial(s, {});
    for (int i = 0; i < kSteps; ++i) {
      double low = double{1} * i / kSteps, high = double{1} * (i + 1) / kSteps;
      if (!(OffsetAt(curve, ray, low).slope <= 0 && OffsetAt(curve, ray, high).slope > 0)) continue;
      for (int halving = 0; halving < 50; ++halving) {
        const double middle = (low + high) / 2;
        (OffsetAt(curve, ray, middle).slope <= 0 ? low : high) = middle;
      }
      const Offset at = OffsetAt(curve, ray, low);
      const double half = SeenCurveWidth(curves, s, low, unit) / 2;
      best.margin = std::min({best.margin, std::abs(at.distance - half), std::abs(at.t)});
      if (at.distance > half || at.t <= 0 || at.t >= best.t) continue;
      best.found = true;
      best.t = at.t;
      best.u = low;
    }
  }
  return best;
}

TEST(CurvePolynomial, BezierSegmentsAreThoseOfDeCasteljau) {
  TestRandom random(1);
  for (const int degree : {2, 3}) {
    Double3 p[4];
    for (Double3& point : p) point = Double3(RandomPoint(random, 3));
    const CurvePolynomial curve = MakeCurvePolynomial(CurveBasis::kBezier, degree, p);
    for (const double u : {0.0, 0.3, 0.8, 1.0}) {
      Double3 q[4] = {p[0], p[1], p[2], p[3]};
      for (int level = degree; level > 0; --level) {
        for (int i = 0; i < level; ++i) q[i] = Lerp(u, q[i], q[i + 1]);
      }
      const Double3 error = curve.At(u) - q[0];
      EXPECT_LT(Dot(error, error), 1e-24) << degree << " " << u;
    }
  }
}

TEST(CurvePolynomial, BSplineSegmentsJoinSmoothlyAndReproduceLines) {
  TestRandom random(2);
  for (const int degree : {2, 3}) {
    Double3 p[5];
    for (Double3& point : p) point = Double3(RandomPoint(random, 3));
    const CurvePolynomial first = MakeCurvePolynomial(CurveBasis::kBSpline, degree, p);
    const CurvePolynomial second = MakeCurvePolynomial(CurveBasis::kBSpline, degree, p + 1);
    const Double3 gap = first.At(1) - second.At(0), kink = first.Derivative(1) - second.Derivative(0);
    EXPECT_LT(Dot(gap, gap), 1e-24);
    EXPECT_LT(Dot(kink, kink), 1e-24);
    // Control points at equal distances on a line: the curve runs along it at constant speed.
    for (int i = 0; i < 5; ++i) p[i] = Double3(1, 2, 3) * i;
    const CurvePolynomial line = MakeCurvePolynomial(CurveBasis::kBSpline, degree, p);
    const double start = degree == 2 ? 0.5 : 1;
    for (const double u : {0.0, 0.4, 1.0}) EXPECT_NEAR(line.At(u).y, 2 * (start + u), 1e-12);
  }
}

class CurveKinds : public testing::TestWithParam<int> {};

TEST_P(CurveKinds, CrossingsAreThoseOfBruteForce) {
  TestRandom random(static_cast<uint64_t>(3 + GetParam()));
  int hits = 0, close = 0, wrong = 0;
  for (int c = 0; c < 6; ++c) {
    const CurveSet curves = RandomCurve(random, GetParam() + 36 * c, {1, 2, 30}, 4, 1.2f);
    for (int i = 0; i < 300; ++i) {
      const Point3 from = RandomPoint(random, i % 3 == 0 ? 4 : 12) + Vec3{1, 2, 30};
      const DoubleRay ray = RayTo(from, RandomPoint(random, 4) + Vec3{1, 2, 30});
      const BruteHit expected = BruteForce(curves, ray);
      Crossing found;
      const bool is_found = IntersectAll(curves, ray, &found);
      hits += expected.found;
      if (expected.margin < 1e-6) {
        ++close;
        continue;
      }
      // Where the curve is seen end on, or bends more sharply than it is wide, it has many minima close to
      // each other, one of which may be left out.
      if (is_found != expected.found || (is_found && std::abs(found.t - expected.t) > 1e-6)) {
        ++wrong;
        continue;
      }
      if (is_found) {
        EXPECT_NEAR(found.u, expected.u, 1e-5);
      }
    }
  }
  EXPECT_GT(hits, 40);
  EXPECT_LE(close, 4);
  EXPECT_LE(wrong, 2);
}

INSTANTIATE_TEST_SUITE_P(Kinds, CurveKinds, testing::Range(0, 36));

TEST(CurveIntersection, TheSplitDepthDoesNotChangeWhatIsHit) {
  TestRandom random(21);
  int hits = 0, different = 0;
  for (int c = 0; c < 12; ++c) {
    CurveSet curves = RandomCurve(random, c, {}, 4, 0.5f);
    for (int i = 0; i < 400; ++i) {
      const DoubleRay ray = RayTo(RandomPoint(random, 12), RandomPoint(random, 3));
      Crossing whole, split;
      curves.split_depth = 0;
      const bool is_whole = IntersectAll(curves, ray, &whole);
      curves.split_depth = 6;
      const bool is_split = IntersectAll(curves, ray, &split);
      hits += is_split;
      if (is_whole != is_split || (is_whole && std::abs(whole.t - split.t) > 1e-9)) ++different;
    }
  }
  EXPECT_GT(hits, 300);
  EXPECT_LE(different, 2);  // seen end on
}

TEST(CurveIntersection, NoRaySlipsThroughBetweenPiecesOrSegments) {
  TestRandom random(22);
  for (int c = 0; c < 24; ++c) {
    // A smooth curve, much longer than wide.
    std::vector<Point3> P;
    for (int i = 0; i < 7; ++i) {
      const auto x = static_cast<float>(i);
      P.push_back(Point3{x, std::sin(x + static_cast<float>(c)), std::cos(x)} + RandomPoint(random, 0.1f));
    }
    const CurveSet curves =
        MakeCurve(CurveSet::Type::kFlat, CurveBasis::kBSpline, 2 + c % 2, std::move(P), 0.02f, 0.02f, c % 4);
    const uint32_t pieces = curves.PrimitiveCount();
    for (int i = 0; i < 500; ++i) {
      const auto piece = static_cast<uint32_t>(random.Next() * static_cast<float>(pieces - 1));
      const CurveSet::Piece joint = curves.PieceOf(piece);
      const CurvePolynomial curve = curves.Polynomial(joint.segment, {});
      const Double3 at = curve.At(joint.u1), along = curve.Derivative(joint.u1);
      const DoubleRay across{at + Double3(RandomPoint(random, 5)), {}};
      // Through a point beside the joint, exactly across the curve.
      const Double3 d = at - across.o;
      const Double3 beside = Cross(d, along) * (0.009 * (2 * random.Next() - 1));
      const double size = std::sqrt(Dot(Cross(d, along), Cross(d, along)));
      // Seen end on, the curve bends more sharply than it is wide, and is nearest to the ray elsewhere.
      if (size < 0.3 * std::sqrt(Dot(d, d) * Dot(along, along))) continue;
      const DoubleRay from_near{across.o + beside * (1 / size) + d * 0.99, d};
      int pieces_hit = 0;  // there
      for (uint32_t other = 0; other < pieces; ++other) {
        Crossing crossing;
        pieces_hit += curves.Intersect(other, from_near, 0.02, &crossing);
      }
      ASSERT_GE(pieces_hit, 1) << "piece " << piece;
      const bool is_inside_segment = joint.u1 < 1;
      if (is_inside_segment) {
        ASSERT_EQ(pieces_hit, 1) << "piece " << piece;
      }
    }
  }
}

TEST(CurveIntersection, BoundsHoldAllHits) {
  TestRandom random(23);
  for (int c = 0; c < 36; ++c) {
    CurveSet curves = RandomCurve(random, c, {100, -50, 20}, 2, 0.7f);
    if (c % 2 == 1) curves.render_from_object = std::make_shared<const Transform>(RandomTransform(random, 5));
    Bounds3 all;
    for (uint32_t i = 0; i < curves.PrimitiveCount(); ++i) all.Add(curves.PrimitiveBounds(i));
    for (int i = 0; i < 300; ++i) {
      const DoubleRay ray =
          RayTo(all.Center() + RandomPoint(random, 12), all.Center() + RandomPoint(random, 2));
      for (uint32_t piece = 0; piece < curves.PrimitiveCount(); ++piece) {
        Crossing crossing;
        if (!curves.Intersect(piece, ray, kNoEnd, &crossing)) continue;
        ASSERT_TRUE(curves.PrimitiveBounds(piece).Contains(ray.At(crossing.t).ToFloat()));
      }
    }
  }
}

TEST(CurveIntersection, SetsOfTheSameKindAndSpaceAreStoredTogether) {
  TestRandom random(27);
  CurveSet first = RandomCurve(random, 4, {}, 3, 0.3f);
  const CurveSet second = RandomCurve(random, 4, {1, 0, 0}, 3, 0.3f);
  const uint32_t count = first.PrimitiveCount();
  ASSERT_TRUE(first.CanTake(second));
  CurveSet both = first;
  both.Take(second);
  ASSERT_EQ(both.PrimitiveCount(), count + second.PrimitiveCount());
  for (int i = 0; i < 500; ++i) {
    const DoubleRay ray = RayTo(RandomPoint(random, 9), RandomPoint(random, 2));
    for (uint32_t piece = 0; piece < both.PrimitiveCount(); ++piece) {
      Crossing a, b;
      const CurveSet& source = piece < count ? first : second;
      const bool expected = source.Intersect(piece < count ? piece : piece - count, ray, kNoEnd, &a);
      ASSERT_EQ(both.Intersect(piece, ray, kNoEnd, &b), expected);
      if (expected) {
        ASSERT_EQ(a.t, b.t);
      }
    }
  }
  CurveSet other = second;
  other.render_from_object = std::make_shared<const Transform>(Scale(1, 2, 3));
  EXPECT_FALSE(first.CanTake(other));
  other = second;
  other.split_depth ^= 1;
  EXPECT_FALSE(first.CanTake(other));
  other = second;
  other.type = CurveSet::Type::kFlat;
  EXPECT_FALSE(first.CanTake(other));
}

}  // namespace
}  // namespace tessera
