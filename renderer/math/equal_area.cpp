#include "renderer/math/equal_area.h"

namespace tessera {
namespace {

// (2 / pi) atan(x) for x in [0, 1] with an error below 1e-7: x P(x^2), P interpolated at Chebyshev nodes.
float ArcTangentOverHalfPi(float x) {
  constexpr float kCoefficients[] = {0.63661969724f, -0.21219690985f, 0.12711362695f, -0.08914771410f,
                                     0.06282714881f, -0.03745218405f, 0.01513914834f, -0.00290285374f};
  const float t = x * x;
  float p = kCoefficients[7];
  for (int i = 6; i >= 0; --i) p = p * t + kCoefficients[i];
  return p * x;
}

}  // namespace

Vec3 EqualAreaSquareToSphere(Point2 p) {
  const float u = 2 * p.x - 1, v = 2 * p.y - 1;
  const float abs_u = std::abs(u), abs_v = std::abs(v);
  // Positive inside the diamond |u| + |v| < 1, which is the upper hemisphere.
  const float signed_distance = 1 - (abs_u + abs_v);
  const float r = 1 - std::abs(signed_distance);  // 1 - |z| = r^2
  const float phi = (r == 0 ? 1 : (abs_v - abs_u) / r + 1) * (kPi / 4);
  const float z = std::copysign(1 - r * r, signed_distance);
  const float sin_theta = r * SafeSqrt(2 - r * r);
  return {std::copysign(std::cos(phi), u) * sin_theta, std::copysign(std::sin(phi), v) * sin_theta, z};
}

Point2 EqualAreaSphereToSquare(Vec3 d) {
  const float x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
  // sqrt(1 - |z|) without cancellation near the poles.
  const float r = std::min(1.0f, std::sqrt((x * x + y * y) / (1 + z)));
  const float larger = std::max(x, y), smaller = std::min(x, y);
  float phi = larger == 0 ? 0 : ArcTangentOverHalfPi(smaller / larger);
  if (x < y) phi = 1 - phi;
  float v = phi * r;
  float u = r - v;
  if (d.z < 0) {  // the lower hemisphere is mirrored across the sides of the diamond
    const float swapped = u;
    u = 1 - v;
    v = 1 - swapped;
  }
  return {0.5f * (std::copysign(u, d.x) + 1), 0.5f * (std::copysign(v, d.y) + 1)};
}

}  // namespace tessera
