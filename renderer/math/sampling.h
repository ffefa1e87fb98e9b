// Maps from the unit square to the shapes that path tracing samples, each beside its density and, where it
// has one, its inverse. Every density says with respect to which measure. Templates over
// `Real` or `Vector2` take single floats or those of eight lanes (lanes.h).
#pragma once

#include <cmath>
#include <limits>

#include "renderer/math/real.h"
#include "renderer/math/vec.h"
#include "renderer/util/hash.h"

namespace tessera {

// Sine and cosine of eighths of a turn: of x * pi / 4 for x in [-1, 1], to the precision of float. Their
// Taylor series, without branches and faster than those of the C library.
template <typename Real>
struct SineCosineOf {
  Real sine, cosine;
};
using SineCosine = SineCosineOf<float>;
template <typename Real>
inline SineCosineOf<Real> SineCosineOfEighth(Real x) {
  constexpr double q = 0.78539816339744831;  // pi / 4
  constexpr double q2 = q * q, q4 = q2 * q2, q6 = q4 * q2, q8 = q4 * q4;
  const Real s0(static_cast<float>(q)), s1(static_cast<float>(-q * q2 / 6)),
      s2(static_cast<float>(q * q4 / 120)), s3(static_cast<float>(-q * q6 / 5040)),
      s4(static_cast<float>(q * q8 / 362880));
  const Real c0(1.0f), c1(static_cast<float>(-q2 / 2)), c2(static_cast<float>(q4 / 24)),
      c3(static_cast<float>(-q6 / 720)), c4(static_cast<float>(q8 / 40320));
  const Real xx = x * x;
  return {x * (s0 + xx * (s1 + xx * (s2 + xx * (s3 + xx * s4)))),
          c0 + xx * (c1 + xx * (c2 + xx * (c3 + xx * c4)))};
}

// Uniform over the unit disk, with little distortion (Shirley and Chiu 1997). Density 1/pi per area.
template <typename Vector2>
inline Vector2 SampleUniformDiskConcentricOf(Vector2 u) {
  using Real = decltype(u.x);
  const Real x = Real(2.0f) * u.x - Real(1.0f), y = Real(2.0f) * u.y - Real(1.0f);
  // The coordinates are exchanged where y is larger: by selections, since a branch could not be predicted.
  const auto is_wide = Abs(x) > Abs(y);
  const Real radius = Select(is_wide, x, y);  // signed
  const Real other = Select(is_wide, y, x);
  const auto [sine, cosine] = SineCosineOfEighth(Select(radius == Real(0.0f), Real(0.0f), other / radius));
  const Real along = radius * cosine, across = radius * sine;
  return {Select(is_wide, along, across), Select(is_wide, across, along)};
}
inline Point2 SampleUniformDiskConcentric(Point2 u) {
  return SampleUniformDiskConcentricOf(u);
}

// Directions about +z with density cos(theta)/pi per solid angle (Malley's method).
inline Vec3 SampleCosineHemisphere(Point2 u) {
  const Point2 d = SampleUniformDiskConcentric(u);
  return {d.x, d.y, SafeSqrt(1 - d.x * d.x - d.y * d.y)};
}
inline float CosineHemispherePdf(float cos_theta) {
  return cos_theta * kInvPi;
}

// Directions with density 1/(4 pi) per solid angle.
inline Vec3 SampleUniformSphere(Point2 u) {
  const float z = 1 - 2 * u.x;
  const float r = SafeSqrt(1 - z * z);
  const float phi = 2 * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), z};
}
constexpr float UniformSpherePdf() {
  return kInv4Pi;
}

// Directions about +z with density 1/(2 pi) per solid angle.
inline Vec3 SampleUniformHemisphere(Point2 u) {
  const float r = SafeSqrt(1 - u.x * u.x);
  const float phi = 2 * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), u.x};
}
constexpr float UniformHemispherePdf() {
  return kInv2Pi;
}

// Barycentric coordinates of a point uniform in a triangle, close to area-preserving (Heitz 2019). Density
// 1/area per area.
inline Vec3 SampleUniformTriangle(Point2 u) {
  float b0, b1;
  if (u.x < u.y) {
    b0 = u.x / 2;
    b1 = u.y - b0;
  } else {
    b1 = u.y / 2;
    b0 = u.x - b1;
  }
  return {b0, b1, 1 - b0 - b1};
}

// x in [0, 1] with density proportional to the line from a at 0 to b at 1.
template <typename Real>
inline Real SampleLinearOf(Real u, Real a, Real b) {
  const Real x = u * (a + b) / (a + Sqrt(Lerp(u, a * a, b * b)));
  return Select((u == Real(0.0f)) & (a == Real(0.0f)), Real(0.0f), Min(x, Real(kOneMinusEpsilon)));
}
inline float SampleLinear(float u, float a, float b) {
  return SampleLinearOf(u, a, b);
}
inline float LinearPdf(float x, float a, float b) {
  if (x < 0 || x > 1) return 0;
  return 2 * Lerp(x, a, b) / (a + b);
}

// A distance with density sigma exp(-sigma t) per length. Infinite if sigma is 0.
inline float SampleExponential(float u, float sigma) {
  return sigma > 0 ? -std::log(1 - u) / sigma : std::numeric_limits<float>::infinity();
}

// Multiple importance sampling weight of a technique with density f_pdf against one with g_pdf, one sample
// each (Veach 1997, power heuristic with exponent 2).
template <typename Real>
inline Real PowerHeuristicOf(Real f_pdf, Real g_pdf) {
  const Real f2 = f_pdf * f_pdf;
  const Real sum = f2 + g_pdf * g_pdf;
  const Real weight = Select(sum > Real(0.0f), f2 / sum, Real(0.0f));
  return Select(f2 == Real(std::numeric_limits<float>::infinity()), Real(1.0f), weight);
}
inline float PowerHeuristic(float f_pdf, float g_pdf) {
  return PowerHeuristicOf(f_pdf, g_pdf);
}

}  // namespace tessera
