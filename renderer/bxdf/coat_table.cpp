#include "renderer/bxdf/coat_table.h"

#include <algorithm>

#include "renderer/bxdf/dielectric_bxdf.h"
#include "renderer/bxdf/fresnel.h"
#include "renderer/math/sampling.h"

namespace tessera {
namespace {

// Points of the midpoint rules below. The tables differ from much finer ones by at most 5e-4.
constexpr int kPhiPoints = 8;      // over half a turn: the other half is its mirror image
constexpr int kHeightPoints = 32;  // of the cap of visible normals
constexpr int kBasePointsSmooth = 1024;
constexpr int kBasePointsRough = 64;
constexpr int kBasePointsSharp = 256;  // of coats below kAlphaSharp: total reflection begins abruptly
constexpr float kAlphaSharp = 0.1f;
constexpr int kMeanPoints = 512;
constexpr float kCosineMin = 1e-4f;  // stands for grazing incidence of a rough coat

float Attenuation(float thickness, float cos_theta) {
  return std::exp(-thickness / std::abs(cos_theta));
}

// Fractions of the light along w, from either side.
struct Scattered {
  float reflected = 0;
  float reflected_attenuated = 0;  // each direction times its attenuation, as the next
  float transmitted_attenuated = 0;
};

// Adds what the microfacet of normal m does to light along w. The estimator of a visible normal is G2/G1
// times the Fresnel term (Walter et al. 2007, Heitz 2018).
void AddMicrofacet(const DielectricBxdf& coat, float thickness, Vec3 w, Vec3 m, float weight,
                   Scattered& sum) {
  const MicrofacetDistribution& facets = coat.facets();
  const float fresnel = FrDielectric(Dot(w, m), coat.eta());
  const auto masking = [&](Vec3 v) {
    const float cos_v = std::abs(v.z), cos_w = std::abs(w.z), stretch_w = facets.Stretch(w);
    return cos_v * (cos_w + stretch_w) / (stretch_w * cos_v + facets.Stretch(v) * cos_w);
  };
  const Vec3 reflected = Reflect(w, m);
  if (SameHemisphere(w, reflected)) {
    const float share = weight * fresnel * masking(reflected);
    sum.reflected += share;
    sum.reflected_attenuated += share * Attenuation(thickness, reflected.z);
  }
  const Refraction refraction = Refract(w, m, coat.eta());
  if (!refraction.exists || !(refraction.wt.z < 0) || w.z < 0)
    return;  // only light from outside needs its transmittance
  const Vec3 wt = refraction.wt;
  sum.transmitted_attenuated += weight * (1 - fresnel) * masking(wt) * Attenuation(thickness, wt.z);
}

// A grid over the normals visible from w. Its rows are denser towards the steepest normals, which reflect
// little light but spread it far.
Scattered IntegrateRough(const DielectricBxdf& coat, float thickness, Vec3 w) {
  Scattered sum;
  for (int j = 0; j < kHeightPoints; ++j) {
    const float v = 1 - (static_cast<float>(j) + 0.5f) / kHeightPoints;
    const float weight = 2 * v / (kPhiPoints * kHeightPoints);
    for (int i = 0; i < kPhiPoints; ++i) {
      const float x = 0.5f * (static_cast<float>(i) + 0.5f) / kPhiPoints;
      AddMicrofacet(coat, thickness, w, coat.facets().SampleVisibleNormal(w, {x, 1 - v * v}), weight, sum);
    }
  }
  return sum;
}

Scattered IntegrateSmooth(float eta, float thickness, Vec3 w) {
  const float fresnel = FrDielectric(w.z, eta);
  Scattered result{fresnel, fresnel * Attenuation(thickness, w.z), 0};
  const Refraction refraction = Refract(w, {0, 0, 1}, eta);
  if (refraction.exists)
    result.transmitted_attenuated = (1 - fresnel) * Attenuation(thickness, refraction.wt.z);
  return result;
}

Scattered Integrate(const DielectricBxdf& coat, float thickness, float cos_theta) {
  if (!coat.IsSpecular() && std::abs(cos_theta) < kCosineMin)
    cos_theta = std::copysign(kCosineMin, cos_theta);
  const Vec3 w{SafeSqrt(1 - Sqr(cos_theta)), 0, cos_theta};
  return coat.IsSpecular() ? IntegrateSmooth(coat.eta(), thickness, w) : IntegrateRough(coat, thickness, w);
}

// The light that leaves the base with a cosine distribution and is reflected back to it by the coat.
float InternalReflectance(const DielectricBxdf& coat, float thickness) {
  const int points_rough = coat.facets().alpha_x() < kAlphaSharp ? kBasePointsSharp : kBasePointsRough;
  const int points = coat.IsSpecular() ? kBasePointsSmooth : points_rough;
  float sum = 0;
  for (int i = 0; i < points; ++i) {
    const float cos_theta = std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(points));
    sum += Attenuation(thickness, cos_theta) * Integrate(coat, thickness, -cos_theta).reflected_attenuated;
  }
  return sum / static_cast<float>(points);
}

CoatRow ComputeRow(float alpha, float eta, float thickness) {
  const DielectricBxdf coat(MicrofacetDistribution(alpha, alpha), eta);
  CoatRow row;
  for (int i = 0; i <= CoatRow::kSteps; ++i) {
    const Scattered s = Integrate(coat, thickness, Sqr(static_cast<float>(i) / CoatRow::kSteps));
    row.angles[i] = {s.transmitted_attenuated, s.reflected};
  }
  row.internal_reflectance = InternalReflectance(coat, thickness);
  for (int i = 0; i < kMeanPoints; ++i) {
    const float cos_theta = std::sqrt((static_cast<float>(i) + 0.5f) / kMeanPoints);
    row.mean_transmittance += row.At(cos_theta).transmittance / kMeanPoints;
  }
  return row;
}

// The i-th of `count` evenly spaced values from a to b.
float Spaced(int i, int count, float a, float b) {
  return a + (b - a) * static_cast<float>(i) / static_cast<float>(count - 1);
}

}  // namespace

CoatTable CoatTable::Constant(float alpha, float eta, float thickness) {
  CoatTable table;
  table.rows_.push_back(ComputeRow(alpha, eta, thickness));
  return table;
}

CoatTable CoatTable::OverAlpha(float eta, float thickness) {
  CoatTable table;
  for (int i = 0; i < kAlphaRows; ++i) {
    table.rows_.push_back(ComputeRow(Spaced(i, kAlphaRows, 0, kAlphaRowMax), eta, thickness));
  }
  table.inverse_step_ = (kAlphaRows - 1) / kAlphaRowMax;
  return table;
}

CoatTable CoatTable::OverEta(float alpha, float eta_min, float eta_max, float thickness) {
  if (!(eta_max > eta_min)) return Constant(alpha, eta_min, thickness);
  CoatTable table;
  for (int i = 0; i < kEtaRows; ++i) {
    table.rows_.push_back(ComputeRow(alpha, Spaced(i, kEtaRows, eta_min, eta_max), thickness));
  }
  table.first_ = eta_min;
  table.inverse_step_ = (kEtaRows - 1) / (eta_max - eta_min);
  return table;
}

CoatLookup CoatTable::At(float parameter) const {
  const int last = static_cast<int>(rows_.size()) - 1;
  if (last == 0) return {&rows_[0], &rows_[0], 0};
  const float x = std::clamp((parameter - first_) * inverse_step_, 0.0f, static_cast<float>(last));
  const int i = std::min(static_cast<int>(x), last - 1);
  return {&rows_[i], &rows_[i + 1], x - static_cast<float>(i)};
}

std::shared_ptr<const CoatTable> CoatTableCache::Constant(float alpha, float eta, float thickness) {
  auto& table = tables_[{0, alpha, eta, eta, thickness}];
  if (!table) table = std::make_shared<const CoatTable>(CoatTable::Constant(alpha, eta, thickness));
  return table;
}

std::shared_ptr<const CoatTable> CoatTableCache::OverAlpha(float eta, float thickness) {
  auto& table = tables_[{1, 0.0f, eta, eta, thickness}];
  if (!table) table = std::make_shared<const CoatTable>(CoatTable::OverAlpha(eta, thickness));
  return table;
}

std::shared_ptr<const CoatTable> CoatTableCache::OverEta(float alpha, float eta_min, float eta_max,
                                                         float thickness) {
  auto& table = tables_[{2, alpha, eta_min, eta_max, thickness}];
  if (!table)
    table = std::make_shared<const CoatTable>(CoatTable::OverEta(alpha, eta_min, eta_max, thickness));
  return table;
}

}  // namespace tessera
