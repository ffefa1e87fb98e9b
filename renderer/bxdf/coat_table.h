// What a clear coat over a surface does to light on average. It is tabulated once, so that a coated surface
// is evaluated in closed form instead of by a random walk between its layers. All quantities include the
// attenuation of the layer, as in pbrt-v4: exp(-thickness / |cos theta|) for each crossing, where theta is
// the angle inside.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

namespace tessera {

// A coat at one angle of incidence from outside.
struct CoatAngle {
  float transmittance = 0;  // fraction of the light from this angle that reaches the base
  float reflectance = 0;    // fraction that the interface reflects
};

// Returns a at t = 0 and b at t = 1.
inline CoatAngle Interpolate(float t, const CoatAngle& a, const CoatAngle& b) {
  return {a.transmittance + t * (b.transmittance - a.transmittance),
          a.reflectance + t * (b.reflectance - a.reflectance)};
}

// One coat: a dielectric interface of microfacets over a layer of some thickness.
struct CoatRow {
  static constexpr int kSteps = 96;
  std::array<CoatAngle, kSteps + 1> angles;  // at cos theta = (i / kSteps)^2
  // The fraction of the light that leaves a Lambertian base that comes back to it.
  float internal_reflectance = 0;
  // The fraction of light incident with a cosine distribution that reaches the base.
  float mean_transmittance = 0;

  // cos_theta in [0, 1], up to rounding.
  CoatAngle At(float cos_theta) const {
    const float x = std::sqrt(std::max(0.0f, cos_theta)) * kSteps;  // 0 if NaN
    const int i = std::min(static_cast<int>(x), kSteps - 1);
    return Interpolate(x - static_cast<float>(i), angles[i], angles[i + 1]);
  }
};

// An interpolated row of a CoatTable. Valid while the table lives.
struct CoatLookup {
  const CoatRow* low = nullptr;
  const CoatRow* high = nullptr;
  float weight = 0;  // of `high`

  CoatAngle At(float cos_theta) const {
    const CoatAngle angle = low->At(cos_theta);
    return weight == 0 ? angle : Interpolate(weight, angle, high->At(cos_theta));
  }
  float internal_reflectance() const { return Mix(low->internal_reflectance, high->internal_reflectance); }
  float mean_transmittance() const { return Mix(low->mean_transmittance, high->mean_transmittance); }

 private:
  float Mix(float a, float b) const { return a + weight * (b - a); }
};

// Coats that differ in one parameter: in alpha, in eta, or in none. Immutable.
class CoatTable {
 public:
  static constexpr int kAlphaRows = 25;     // over [0, 1]
  static constexpr int kEtaRows = 9;        // over the range of eta of a dispersive coat
  static constexpr float kAlphaRowMax = 1;  // rougher coats are not tabulated

  // alpha: of the isotropic interface; eta: the index of refraction of the layer relative to the outside;
  // thickness: in units of the mean free path, positive.
  static CoatTable Constant(float alpha, float eta, float thickness);
  static CoatTable OverAlpha(float eta, float thickness);
  static CoatTable OverEta(float alpha, float eta_min, float eta_max, float thickness);

  // Returns the coat of this alpha or eta, clamped to the range of the table. A constant table ignores it.
  CoatLookup At(float parameter) const;

 private:
  std::vector<CoatRow> rows_;
  float first_ = 0, inverse_step_ = 0;
};

// Computes each table once.
class CoatTableCache {
 public:
  std::shared_ptr<const CoatTable> Constant(float alpha, float eta, float thickness);
  std::shared_ptr<const CoatTable> OverAlpha(float eta, float thickness);
  std::shared_ptr<const CoatTable> OverEta(float alpha, float eta_min, float eta_max, float thickness);

 private:
  using Key = std::tuple<int, float, float, float, float>;
  std::map<Key, std::shared_ptr<const CoatTable>> tables_;
};

}  // namespace tessera
