#include "material/coat_table.h"

#include <algorithm>

#include "material/fresnel.h"
#include "material/microfacet.h"

namespace tessera {
namespace {

// Points of the midpoint rules below. Tables then agree with much finer ones to about 1e-4.
constexpr int kPhiPoints = 16;     // over half a turn: the other half is its mirror image
constexpr int kHeightPoints = 48;  // of the cap of visible normals
constexpr int kBasePointsSmooth = 1024;
constexpr int kBasePointsRough = 96;
constexpr int kMeanPoints = 512;
constexpr float kCosineMin = 1e-4f;  // stands for grazing incidence of a rough coat

float Attenuation(float thickness, float cos_theta) {
  return std::exp(-thickness / std::abs(cos_theta));
}

struct Scattered {
  float reflected = 0;             // share
  float reflected_attenuated = 0;  // each direction times its attenuation
  float transmitted_attenuated = 0;
};

// Integrates the microfacet interface over outgoing directions for light along w, by a grid over the normals
// that w sees. The estimator of such a normal is G2/G1 times the Fresnel term. (Walter et al. 2007, Heitz
// 2018.)
Scattered IntegrateRough(const MicrofacetDistribution& facets, float eta, float thickness, Vec3 w) {
  const float stretch_w = facets.Stretch(w), cos_w = std::abs(w.z);
  const auto masking = [&](Vec3 v) {
    const float cos_v = std::abs(v.z);
    return cos_v * (cos_w + stretch_w) / (stretch_w * cos_v + facets.Stretch(v) * cos_w);
  };
  Scattered sum;
  for (int j = 0; j < kHeightPoints; ++j) {
    for (int i = 0; i < kPhiPoints; ++i) {
      const float x = 0.5f * (static_cast<float>(i) + 0.5f) / kPhiPoints;
      const float y = (static_cast<float>(j) + 0.5f) / kHeightPoints;
      const Vec3 m = facets.SampleVisibleNormal(w, {x, y});
      const float fresnel = FrDielectric(Dot(w, m), eta);
      const Vec3 reflected = Reflect(w, m);
      if (SameHemisphere(w, reflected)) {
        const float weight = fresnel * masking(reflected);
        sum.reflected += weight;
        sum.reflected_attenuated += weight * Attenuation(thickness, reflected.z);
      }
      const Refraction refraction = Refract(w, m, eta);
      if (refraction.exists && refraction.wt.z * w.z < 0) {
        const Vec3 wt = refraction.wt;
        sum.transmitted_attenuated += (1 - fresnel) * masking(wt) * Attenuation(thickness, wt.z);
      }
    }
  }
  constexpr float kWeight = 1.0f / (kPhiPoints * kHeightPoints);
  return {sum.reflected * kWeight, sum.reflected_attenuated * kWeight, sum.transmitted_attenuated * kWeight};
}

Scattered IntegrateSmooth(float eta, float thickness, Vec3 w) {
  const float fresnel = FrDielectric(w.z, eta);
  Scattered result{fresnel, fresnel * Attenuation(thickness, w.z), 0};
  const Refraction refraction = Refract(w, {0, 0, 1}, eta);
  if (refraction.exists)
    result.transmitted_attenuated = (1 - fresnel) * Attenuation(thickness, refraction.wt.z);
  return result;
}

Scattered Integrate(const MicrofacetDistribution& facets, float eta, float thickness, float cos_theta) {
  if (facets.IsSmooth()) return IntegrateSmooth(eta, thickness, {SafeSqrt(1 - Sqr(cos_theta)), 0, cos_theta});
  if (std::abs(cos_theta) < kCosineMin) cos_theta = std::copysign(kCosineMin, cos_theta);
  return IntegrateRough(facets, eta, thickness, {SafeSqrt(1 - Sqr(cos_theta)), 0, cos_theta});
}

// Light goes up from the base with a cosine distribution, through the layer, is reflected, and comes down
// again.
float InternalReflectance(const MicrofacetDistribution& facets, float eta, float thickness) {
  const int points = facets.IsSmooth() ? kBasePointsSmooth : kBasePointsRough;
  float sum = 0;
  for (int i = 0; i < points; ++i) {
    const float cos_theta = std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(points));
    sum += Attenuation(thickness, cos_theta) *
           Integrate(facets, eta, thickness, -cos_theta).reflected_attenuated;
  }
  return sum / static_cast<float>(points);
}

CoatRow ComputeRow(float alpha, float eta, float thickness) {
  const MicrofacetDistribution facets(alpha, alpha);
  CoatRow row;
  for (int i = 0; i <= CoatRow::kSteps; ++i) {
    const float cos_theta = Sqr(static_cast<float>(i) / CoatRow::kSteps);
    const Scattered s = Integrate(facets, eta, thickness, cos_theta);
    row.entries[i] = {s.transmitted_attenuated, s.reflected};
  }
  row.internal_reflectance = InternalReflectance(facets, eta, thickness);
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
