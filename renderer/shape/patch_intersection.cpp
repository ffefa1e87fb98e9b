#include "renderer/shape/patch_intersection.h"

#include <algorithm>

#include "renderer/shape/triangle.h"

namespace tessera {
namespace {

// Roots of a + b x + c x^2. Returns their number.
int SolveQuadratic(double a, double b, double c, double roots[2]) {
  if (c == 0) {
    if (b == 0) return 0;
    roots[0] = -a / b;
    return 1;
  }
  const double discriminant = b * b - 4 * a * c;
  if (!(discriminant >= 0)) return 0;
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  roots[0] = q / c;
  if (q == 0) return 1;  // both are 0
  roots[1] = a / q;
  return 2;
}

}  // namespace

bool IntersectPatch(const PatchPoints& patch, const DoubleRay& ray, double t_max, Crossing* crossing) {
  const Double3 q00 = Double3(patch.p00) - ray.o;
  const Double3 q10 = Double3(patch.p10) - ray.o;
  const Double3 e00 = Difference(patch.p01, patch.p00);
  const Double3 e11 = Difference(patch.p11, patch.p10);
  // The signed distance of the ray to the iso-line at u is proportional to a + b u + c u^2.
  const double a = Dot(Cross(q00, ray.d), e00);
  const double c = Dot(Cross(Difference(patch.p10, patch.p00), Difference(patch.p01, patch.p11)), ray.d);
  const double b = Dot(Cross(q10, ray.d), e11) - (a + c);
  double roots[2];
  const int count = SolveQuadratic(a, b, c, roots);
  bool found = false;
  for (int i = 0; i < count; ++i) {
    const double u = roots[i];
    if (!(u >= 0 && u <= 1)) continue;
    const Double3 start = Lerp(u, q00, q10);  // of the iso-line, as seen from the ray's origin
    const Double3 along = Lerp(u, e00, e11);
    const Double3 n = Cross(ray.d, along);
    const double n_squared = Dot(n, n);
    if (!(n_squared > 0)) continue;
    const Double3 m = Cross(n, start);
    const double v = Dot(m, ray.d) / n_squared;
    const double t = Dot(m, along) / n_squared;
    if (!(v >= 0 && v <= 1 && t > 0 && t <= t_max)) continue;
    t_max = t;
    *crossing = {t, static_cast<float>(u), static_cast<float>(v)};
    found = true;
  }
  return found;
}

bool CrossParallelogram(const PatchPoints& patch, const DoubleRay& ray, Crossing* crossing) {
  TriangleCrossing found;
  if (!CrossTriangle({patch.p00, patch.p10, patch.p01}, ray, &found)) return false;
  crossing->t = found.t;
  crossing->u = static_cast<float>(std::clamp(found.u, 0.0, 1.0));
  crossing->v = static_cast<float>(std::clamp(found.v, 0.0, 1.0));
  return true;
}

}  // namespace tessera
