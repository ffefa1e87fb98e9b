#include "renderer/shape/patch.h"

#include <algorithm>
#include <cmath>

#include "renderer/math/ray.h"

namespace tessera {

Point3 PatchPoint(const PatchPoints& patch, Point2 uv) {
  const Double3 v0 = Lerp(uv.x, Double3(patch.p00), Double3(patch.p10));
  const Double3 v1 = Lerp(uv.x, Double3(patch.p01), Double3(patch.p11));
  return Lerp(uv.y, v0, v1).ToFloat();
}

Vec3 PatchPointError(const PatchPoints& patch) {
  return (Abs(patch.p00) + Abs(patch.p10) + Abs(patch.p01) + Abs(patch.p11)) * Gamma(6);
}

PatchDerivatives DifferentiatePatch(const PatchPoints& patch, Point2 uv) {
  return {DerivativeByU(uv, patch.p00, patch.p10, patch.p01, patch.p11),
          DerivativeByV(uv, patch.p00, patch.p10, patch.p01, patch.p11)};
}

bool IsParallelogram(const PatchPoints& patch) {
  const Vec3 gap = (patch.p00 - patch.p10) + (patch.p11 - patch.p01);
  const Vec3 largest = Max(Max(Abs(patch.p00), Abs(patch.p10)), Max(Abs(patch.p01), Abs(patch.p11)));
  return MaxComponent(Abs(gap)) <= kParallelogramTolerance * MaxComponent(largest);
}

bool IsRectangle(const PatchPoints& patch) {
  const auto& [p00, p10, p01, p11] = patch;
  if (p00 == p01 || p01 == p11 || p11 == p10 || p10 == p00) return false;
  const Vec3 cross = Cross(p10 - p00, p01 - p00);
  if (LengthSquared(cross) == 0 || p11 == p00) return false;
  if (AbsDot(Normalize(p11 - p00), Normalize(cross)) > 1e-5f) return false;
  const Point3 center = (p00 + p10 + p01 + p11) * 0.25f;
  const float reference = DistanceSquared(p00, center);
  for (const Point3 p : {p10, p01, p11}) {
    if (std::abs(DistanceSquared(p, center) - reference) / reference > 1e-4f) return false;
  }
  return true;
}

float PatchArea(const PatchPoints& patch) {
  if (IsRectangle(patch)) return Distance(patch.p00, patch.p01) * Distance(patch.p00, patch.p10);
  // Midpoint rule; the integrand is a square root of a polynomial of degree 4, smooth but for degenerate
  // patches.
  constexpr int kSteps = 8;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j)
      sum += Length(PatchCross(patch, {(i + 0.5f) / kSteps, (j + 0.5f) / kSteps}));
  }
  return static_cast<float>(sum / (kSteps * kSteps));
}

Point2 InvertPatch(const PatchPoints& patch, Point3 p) {
  constexpr int kIterations = 12;
  constexpr double kSmallStep = 1e-9;
  const Double3 p00(patch.p00), e10 = Difference(patch.p10, patch.p00),
                                e01 = Difference(patch.p01, patch.p00);
  const Double3 twist = Difference(patch.p11, patch.p10) - e01;
  double u = 0.5, v = 0.5;
  for (int i = 0; i < kIterations; ++i) {
    const Double3 by_u = e10 + twist * v, by_v = e01 + twist * u;
    const Double3 residual = p00 + e10 * u + e01 * v + twist * (u * v) - Double3(p);
    const double uu = Dot(by_u, by_u), uv = Dot(by_u, by_v), vv = Dot(by_v, by_v);
    const double determinant = uu * vv - uv * uv;
    if (!(determinant > 0)) break;
    const double ru = Dot(by_u, residual), rv = Dot(by_v, residual);
    const double du = (vv * ru - uv * rv) / determinant, dv = (uu * rv - uv * ru) / determinant;
    u -= du;
    v -= dv;
    if (std::abs(du) < kSmallStep && std::abs(dv) < kSmallStep) break;
  }
  return {static_cast<float>(std::clamp(u, 0.0, 1.0)), static_cast<float>(std::clamp(v, 0.0, 1.0))};
}

}  // namespace tessera
