// Distances along a ray that are dense where it passes a light (C. Kulla, M. Fajardo, "Importance Sampling
// Techniques for Path Tracing in Participating Media", 2012).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "renderer/math/bounds.h"
#include "renderer/math/ray.h"

namespace tessera {

// Distances from 0 to infinity, uniform in the angle that they have at the center of the light: so the
// falloff of light with the square of the distance cancels. A light of some size counts as if the ray passed
// it at its radius.
class EquiAngular {
 public:
  // The direction of the ray is of unit length; its t_max does not matter.
  EquiAngular(const Ray& ray, const BoundingSphere& light) {
    const Vec3 to_light = light.center - ray.o;
    nearest_ = Dot(to_light, ray.d);
    // Below this part of the distance float does not resolve how far from the ray the light is.
    constexpr float kResolved = 1e-6f;
    const float resolved = Sqr(kResolved) * LengthSquared(to_light);
    const float across_squared = LengthSquared(to_light - ray.d * nearest_) + Sqr(light.radius);
    across_ = std::sqrt(std::max(across_squared, resolved));
  }

  struct Drawn {
    float t = 0;
    float pdf = 0;  // per length
  };
  // For u in [0, 1); t is infinite for 0.
  Drawn Sample(float u) const {
    const float angle = Angle();
    const float tangent = std::tan(u * angle);
    if (tangent == 0) return {std::numeric_limits<float>::infinity(), 0};
    const float t = std::max(nearest_ + across_ / tangent, 0.0f);
    return {t, PdfOf(angle, t)};
  }
  float Pdf(float t) const { return PdfOf(Angle(), t); }
  // How near the ray comes to the light.
  float distance() const { return nearest_ >= 0 ? across_ : std::sqrt(Sqr(across_) + Sqr(nearest_)); }

 private:
  // Of the ray at the light, in (0, pi).
  float Angle() const { return std::atan2(across_, -nearest_); }
  float PdfOf(float angle, float t) const { return across_ / (angle * (Sqr(across_) + Sqr(t - nearest_))); }

  float nearest_;  // distance along the ray of the point nearest to the light, negative if that is behind
  float across_;   // from there to the light
};

}  // namespace tessera
