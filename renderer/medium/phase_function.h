// How a medium scatters light at a point: the phase function of L. Henyey and J. Greenstein ("Diffuse
// Radiation in the Galaxy", 1941). It is normalised over the sphere, so it is its own density per solid
// angle.
#pragma once

#include <algorithm>
#include <cmath>

#include "renderer/math/vec.h"

namespace tessera {

struct PhaseSample {
  Vec3 wi;        // unit
  float pdf = 0;  // per solid angle; also the value of the phase function
};

// Directions are unit vectors that point away from the point of scattering: light that is not deflected has
// wi = -wo.
class PhaseFunction {
 public:
  PhaseFunction() = default;
  // `g` is the mean cosine of the deflection, in [-1, 1]; what is too near to a mirror for floats is bounded.
  explicit PhaseFunction(float g) : g_(std::clamp(g, -kAsymmetryMax, kAsymmetryMax)) {}

  // Per steradian.
  float Evaluate(Vec3 wo, Vec3 wi) const { return Value(-Dot(wo, wi)); }
  float Pdf(Vec3 wo, Vec3 wi) const { return Evaluate(wo, wi); }

  PhaseSample Sample(Vec3 wo, Point2 u) const {
    // The inverse of the distribution function of the cosine, expanded so that it holds for g = 0 too.
    const float x = 2 * u.x - 1;
    const float gg = g_ * g_;
    const float numerator = x * (1 + gg) + 0.5f * g_ * ((x * x + 3) + gg * (x * x - 1));
    const float cos_theta = std::clamp(numerator / Sqr(1 + g_ * x), -1.0f, 1.0f);
    const float sin_theta = SafeSqrt(1 - cos_theta * cos_theta);
    const float phi = 2 * kPi * u.y;
    const Vec3 local{sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta};
    return {Frame::FromZ(-wo).FromLocal(local), Value(cos_theta)};
  }

 private:
  static constexpr float kAsymmetryMax = 0.99f;  // as in pbrt-v4

  float Value(float cos_theta) const {
    const float denominator = std::max(1 + g_ * g_ - 2 * g_ * cos_theta, 1e-6f);
    return kInv4Pi * (1 - g_ * g_) / (denominator * std::sqrt(denominator));
  }

  float g_ = 0;
};

}  // namespace tessera
