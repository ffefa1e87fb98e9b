// One segment of a curve as a polynomial of u in [0, 1], in double precision: the same for all bases.
#pragma once

#include "renderer/shape/double3.h"

namespace tessera {

enum class CurveBasis : uint8_t { kBezier, kBSpline };

// c[0] + c[1] u + c[2] u^2 + c[3] u^3.
struct CurvePolynomial {
  Double3 c[4];

  Double3 At(double u) const { return c[0] + (c[1] + (c[2] + c[3] * u) * u) * u; }
  Double3 Derivative(double u) const { return c[1] + (c[2] * 2 + c[3] * (3 * u)) * u; }
};

// `degree` is 2 or 3; `p` has degree + 1 control points.
inline CurvePolynomial MakeCurvePolynomial(CurveBasis basis, int degree, const Double3* p) {
  const bool is_bezier = basis == CurveBasis::kBezier;
  const Double3 first = p[1] - p[0];
  const Double3 second = p[2] - p[1] - first;
  if (degree == 2) {
    if (is_bezier) return {{p[0], first * 2, second, {}}};
    return {{(p[0] + p[1]) * 0.5, first, second * 0.5, {}}};
  }
  const Double3 third = (p[3] - p[0]) - (p[2] - p[1]) * 3;
  if (is_bezier) return {{p[0], first * 3, second * 3, third}};
  const double sixth = 1.0 / 6;
  return {{(p[0] + p[1] * 4 + p[2]) * sixth, (p[2] - p[0]) * 0.5, second * 0.5, third * sixth}};
}

// The Bezier control points of the part from u0 to u1.
struct CurveHull {
  Double3 p[4];
};
inline CurveHull HullOf(const CurvePolynomial& curve, double u0, double u1) {
  const double third = (u1 - u0) / 3;
  const Double3 start = curve.At(u0), end = curve.At(u1);
  return {{start, start + curve.Derivative(u0) * third, end - curve.Derivative(u1) * third, end}};
}

}  // namespace tessera
