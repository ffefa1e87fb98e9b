// How a medium scatters light at a point: the phase function of Henyey and Greenstein.
#pragma once

#include <algorithm>

#include "renderer/math/henyey_greenstein.h"
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
  // `g` is the mean cosine of the deflection, in [-1, 1]; clamped where floats no longer resolve the peak.
  explicit PhaseFunction(float g) : g_(std::clamp(g, -kAsymmetryMax, kAsymmetryMax)) {}

  // Per steradian.
  float Evaluate(Vec3 wo, Vec3 wi) const { return HenyeyGreenstein(-Dot(wo, wi), g_); }
  float Pdf(Vec3 wo, Vec3 wi) const { return Evaluate(wo, wi); }

  PhaseSample Sample(Vec3 wo, Point2 u) const {
    const float cos_theta = SampleHenyeyGreensteinDeflection(g_, u.x);
    return {DirectionAround(-wo, cos_theta, u.y), HenyeyGreenstein(cos_theta, g_)};
  }

 private:
  static constexpr float kAsymmetryMax = 0.99f;  // as in pbrt-v4

  float g_ = 0;
};

}  // namespace tessera
