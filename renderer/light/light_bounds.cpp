#include "renderer/light/light_bounds.h"

#include "renderer/math/transform.h"

namespace tessera {
namespace {

float SafeAcos(float x) {
  return std::acos(std::clamp(x, -1.0f, 1.0f));
}

// `v` turned by `angle` about the unit vector `axis`, which is orthogonal to it.
Vec3 TurnOrthogonal(Vec3 v, Vec3 axis, float angle) {
  return Normalize(v * std::cos(angle) + Cross(axis, v) * std::sin(angle));
}

}  // namespace

void LightBounds::AddAllDirections() {
  cos_theta_o = -1;
  cos_theta_e = 0;
  plane_min = -std::numeric_limits<float>::infinity();
}

NormalCone Union(const NormalCone& a, const NormalCone& b) {
  if (a.axis == b.axis) return {a.axis, std::min(a.cos_angle, b.cos_angle)};
  const float angle_a = SafeAcos(a.cos_angle), angle_b = SafeAcos(b.cos_angle);
  const float between = AngleBetween(a.axis, b.axis);
  if (std::min(between + angle_b, kPi) <= angle_a) return a;
  if (std::min(between + angle_a, kPi) <= angle_b) return b;
  const float angle = (angle_a + between + angle_b) / 2;
  const Vec3 around = Cross(a.axis, b.axis);
  if (angle >= kPi || IsZero(around)) return {a.axis, -1};
  return {TurnOrthogonal(a.axis, Normalize(around), angle - angle_a), std::cos(angle)};
}

LightBounds Union(const LightBounds& a, const LightBounds& b) {
  if (a.strength == 0) return b;
  if (b.strength == 0) return a;
  const NormalCone cone = Union(NormalCone{a.axis, a.cos_theta_o}, NormalCone{b.axis, b.cos_theta_o});
  LightBounds r;
  r.box = Union(a.box, b.box);
  r.axis = cone.axis;
  r.cos_theta_o = cone.cos_angle;
  r.cos_theta_e = std::min(a.cos_theta_e, b.cos_theta_e);
  r.strength = a.strength + b.strength;
  r.two_sided = a.two_sided || b.two_sided;
  // The planes of both hold for the union only if they are measured along the very same axis.
  if (a.axis == b.axis && a.axis == r.axis) r.plane_min = std::min(a.plane_min, b.plane_min);
  return r;
}

float ClusterCost(const LightBounds& bounds) {
  const float theta_o = SafeAcos(bounds.cos_theta_o), theta_e = SafeAcos(bounds.cos_theta_e);
  const float theta_w = std::min(theta_o + theta_e, kPi);
  const float sin_o = SafeSqrt(1 - Sqr(bounds.cos_theta_o));
  const float directions =
      2 * kPi * (1 - bounds.cos_theta_o) +
      kPi / 2 *
          (2 * theta_w * sin_o - std::cos(theta_o - 2 * theta_w) - 2 * theta_o * sin_o + bounds.cos_theta_o);
  return bounds.strength * directions * LengthSquared(bounds.box.Diagonal());
}

}  // namespace tessera
