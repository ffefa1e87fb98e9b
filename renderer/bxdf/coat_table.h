// What a clear coat over a surface does to light on average, tabulated once so that a coated surface is
// evaluated in closed form instead of by a random walk between its layers. All quantities include the
// attenuation of the layer: exp(-thickness / |cos theta|) for each crossing, theta being the angle inside, as
// in pbrt-v4.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

namespace tessera {

// A coat at one angle outside of it.
struct CoatAngle {
  float transmittance = 0;  // share of the light from this angle that reaches the base
  float reflectance = 0;    // share that the interface reflects
};

// Between a at t = 0 and b at t = 1.
inline CoatAngle Interpolate(float t, const CoatAngle& a, const CoatAngle& b) {
  return {a.transmittance + t * (b.transmittance - a.transmittance),
          a.reflectance + t * (b.reflectance - a.reflectance)};
}

// One coat: a dielectric interface of microfacets over a layer of a thickness.
struct CoatRow {
  static constexpr int kSteps = 96;
  std::array<CoatAngle, kSteps + 1> angles;  // at cos theta = (i / kSteps)^2
  // Of light that leaves a Lambertian base: the share that comes back to it.
  float internal_reflectance = 0;
  // Of light that falls on the coat with a cosine distribution: the share that reaches the base.
  float mean_transmittance = 0;

  // cos_theta in [0, 1], up to rounding.
  CoatAngle At(float cos_theta) const {
    const float x = std::sqrt(std::max(0.0f, cos_theta)) * kSteps;  // 0 for what is not a number
    const int i = std::min(static_cast<int>(x), kSteps - 1);
    return Interpolate(x - static_cast<float>(i), angles[i], angles[i + 1]);
  }
};

// A place between two rows of a CoatTable. Valid while the table lives.
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
  static constexpr int kEtaRows = 9;        // over the range of a dispersing coat
  static constexpr float kAlphaRowMax = 1;  // rougher coats are outside the table

  // alpha: of the isotropic interface; eta: index of the layer over that outside; thickness: in units of the
  // mean free path, positive.
  static CoatTable Constant(float alpha, float eta, float thickness);
  static CoatTable OverAlpha(float eta, float thickness);
  static CoatTable OverEta(float alpha, float eta_min, float eta_max, float thickness);

  // The coat of this alpha or eta (anything if the table is constant). Clamped to the ends.
  CoatLookup At(float parameter) const;

 private:
  std::vector<CoatRow> rows_;
  float first_ = 0, inverse_step_ = 0;
};

// Tables by what they were made from, each made once.
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
