// Curves for the tests of shapes and accelerators.
#pragma once

#include <utility>
#include <vector>

#include "tests/renderer/shape/example_shapes.h"

namespace tessera {

// One curve through `P`; the width is linear from segment to segment.
inline CurveSet MakeCurve(CurveSet::Type type, CurveBasis basis, int degree, std::vector<Point3> P,
                          float width0, float width1, int split_depth = 3) {
  CurveSet curves;
  curves.type = type;
  curves.basis = basis;
  curves.degree = static_cast<uint8_t>(degree);
  curves.split_depth = static_cast<uint8_t>(split_depth);
  const auto d = static_cast<uint32_t>(degree), points = static_cast<uint32_t>(P.size());
  const bool is_bezier = basis == CurveBasis::kBezier;
  const uint32_t count = is_bezier ? (points - 1) / d : points - d;
  for (uint32_t i = 0; i < count; ++i) {
    const auto width_at = [&](uint32_t at) {
      return Lerp(static_cast<float>(at) / static_cast<float>(count), width0, width1);
    };
    curves.segments.push_back({i * (is_bezier ? d : 1), width_at(i), width_at(i + 1)});
    if (type == CurveSet::Type::kRibbon) {
      const float turn = static_cast<float>(i);
      curves.N.push_back(Normalize({0.3f, std::cos(turn), std::sin(turn)}));
      curves.N.push_back(Normalize({0.3f, std::cos(turn + 1), std::sin(turn + 1)}));
    }
  }
  curves.P = std::move(P);
  return curves;
}

// Straight from `a` to `b`, with u linear in length.
inline CurveSet StraightCurve(CurveSet::Type type, Point3 a, Point3 b, float width0, float width1,
                              int split_depth = 3) {
  return MakeCurve(type, CurveBasis::kBezier, 3, {a, Lerp(1.f / 3, a, b), Lerp(2.f / 3, a, b), b}, width0,
                   width1, split_depth);
}

// Of any type, basis and degree, with two to four segments, within a cube of half size `size` around
// `center`.
inline CurveSet RandomCurve(TestRandom& random, int kind, Point3 center, float size, float width) {
  const auto type = static_cast<CurveSet::Type>(kind % 3);
  const auto basis = static_cast<CurveBasis>(kind / 3 % 2);
  const int degree = 2 + kind / 6 % 2, segments = 2 + kind / 12 % 3;
  const int points = basis == CurveBasis::kBezier ? degree * segments + 1 : degree + segments;
  std::vector<Point3> P;
  for (int i = 0; i < points; ++i) P.push_back(center + RandomPoint(random, size));
  const float width0 = width * (0.2f + random.Next()), width1 = width * (0.2f + random.Next());
  return MakeCurve(type, basis, degree, std::move(P), width0, width1, kind / 36 % 5);
}

constexpr double kNoEnd = std::numeric_limits<double>::infinity();

// The nearest crossing among all pieces.
inline bool IntersectAll(const CurveSet& curves, const DoubleRay& ray, Crossing* nearest) {
  bool found = false;
  nearest->t = kNoEnd;
  for (uint32_t i = 0; i < curves.PrimitiveCount(); ++i) {
    Crossing crossing;
    if (!curves.Intersect(i, ray, kNoEnd, &crossing)) continue;
    if (crossing.t < nearest->t) *nearest = crossing;
    found = true;
  }
  return found;
}

}  // namespace tessera
