// Reflection and refraction at a smooth interface.
#pragma once

#include <algorithm>
#include <cmath>

#include "renderer/color/sampled_spectrum.h"
#include "renderer/math/vec.h"

namespace tessera {

inline Vec3 Reflect(Vec3 wo, Vec3 n) {
  return n * (2 * Dot(wo, n)) - wo;
}

// A refracted direction and the relative index along it: that of the far side over that of the near side.
struct Refraction {
  bool exists = false;  // false: total internal reflection
  Vec3 wt;
  float etap = 1;
};

// Refracts w (pointing away from the surface) at the normal n. eta is the index below n over that above; w
// may be on either side.
inline Refraction Refract(Vec3 w, Vec3 n, float eta) {
  float cos_i = Dot(n, w);
  if (cos_i < 0) {
    eta = 1 / eta;
    cos_i = -cos_i;
    n = -n;
  }
  const float sin2_t = std::max(0.0f, 1 - cos_i * cos_i) / (eta * eta);
  if (sin2_t >= 1) return {};
  const float cos_t = std::sqrt(1 - sin2_t);
  return {true, n * (cos_i / eta - cos_t) - w / eta, eta};
}

// The fraction of unpolarised light that is reflected. eta is the index below over that above; cos_i < 0:
// from below.
inline float FrDielectric(float cos_i, float eta) {
  cos_i = std::clamp(cos_i, -1.0f, 1.0f);
  if (cos_i < 0) {
    eta = 1 / eta;
    cos_i = -cos_i;
  }
  const float sin2_t = (1 - cos_i * cos_i) / (eta * eta);
  if (sin2_t >= 1) return 1;
  const float cos_t = SafeSqrt(1 - sin2_t);
  const float parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const float perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  return (parallel * parallel + perpendicular * perpendicular) / 2;
}

// The same for a metal with the relative index eta + i k, at four wavelengths (S. Lagarde, "Memo on Fresnel
// equations", 2013). With R_p = R_s (t3 - t4)/(t3 + t4) the mean of both polarisations is R_s t3/(t3 + t4),
// which needs one division.
inline SampledSpectrum FrConductor(float cos_i, SampledSpectrum eta, SampledSpectrum k) {
  cos_i = std::clamp(cos_i, 0.0f, 1.0f);
  const float cos2 = cos_i * cos_i, sin2 = 1 - cos2;
  const Float4 eta2 = eta * eta, k2 = k * k;
  const Float4 t0 = eta2 - k2 - Float4(sin2);
  const Float4 a2_plus_b2 = Sqrt(t0 * t0 + 4.0f * eta2 * k2);
  const Float4 a = SafeSqrt(0.5f * (a2_plus_b2 + t0));
  const Float4 t1 = a2_plus_b2 + cos2;
  const Float4 t2 = (2 * cos_i) * a;
  const Float4 t3 = cos2 * a2_plus_b2 + sin2 * sin2;
  const Float4 t4 = t2 * sin2;
  return SafeDiv((t1 - t2) * t3, (t1 + t2) * (t3 + t4));
}

}  // namespace tessera
