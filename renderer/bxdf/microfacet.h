// The Trowbridge-Reitz (GGX) distribution of microfacet normals with Smith's height-correlated shadowing.
// Directions are in the shading frame.
#pragma once

#include <algorithm>
#include <cmath>

#include "renderer/math/sampling.h"
#include "renderer/math/vec.h"

namespace tessera {

class MicrofacetDistribution {
 public:
  static constexpr float kAlphaSmooth = 1e-3f;  // below: a mirror, as in pbrt-v4
  static constexpr float kAlphaMin = 1e-4f;  // of the narrow axis of a rough surface: keeps densities finite
  static constexpr float kAlphaMax = 100;    // rougher than any surface; keeps products finite

  MicrofacetDistribution() = default;  // smooth
  // Any values are allowed, as textures may hold them. NaN counts as 0.
  MicrofacetDistribution(float alpha_x, float alpha_y) {
    const float x = std::min(kAlphaMax, std::max(0.0f, alpha_x));
    const float y = std::min(kAlphaMax, std::max(0.0f, alpha_y));
    smooth_ = std::max(x, y) < kAlphaSmooth;
    if (smooth_) return;
    alpha_x_ = std::max(x, kAlphaMin);
    alpha_y_ = std::max(y, kAlphaMin);
    inverse_x_ = 1 / alpha_x_;
    inverse_y_ = 1 / alpha_y_;
  }
  // pbrt-v4's remapping of the perceived roughness.
  static float AlphaFromRoughness(float roughness) { return SafeSqrt(roughness); }

  // As pbrt-v4's `regularize`: smooth surfaces become so rough that light sampling finds what they reflect.
  MicrofacetDistribution Regularized() const {
    const auto wider = [](float alpha) { return alpha < 0.3f ? std::clamp(2 * alpha, 0.1f, 0.3f) : alpha; };
    return {wider(alpha_x_), wider(alpha_y_)};
  }

  bool IsSmooth() const { return smooth_; }
  float alpha_x() const { return alpha_x_; }
  float alpha_y() const { return alpha_y_; }

  // Area of microfacets per solid angle about h / |h|, per area of surface. length2 is the square of |h|.
  float D(Vec3 h, float length2) const {
    const float e = Sqr(h.x * inverse_x_) + Sqr(h.y * inverse_y_) + h.z * h.z;
    return length2 * length2 * inverse_x_ * inverse_y_ / (kPi * e * e);
  }
  // |(alpha_x w.x, alpha_y w.y, w.z)|, from which the Smith terms follow: Lambda = (Stretch / |w.z| - 1) / 2.
  float Stretch(Vec3 w) const { return std::sqrt(Sqr(alpha_x_ * w.x) + Sqr(alpha_y_ * w.y) + w.z * w.z); }
  // Fraction of the microfacets that are visible from w.
  float G1(Vec3 w) const { return 2 * std::abs(w.z) / (std::abs(w.z) + Stretch(w)); }
  // Fraction visible from both, divided by |a.z b.z|.
  static float G2OverCosines(Vec3 a, float stretch_a, Vec3 b, float stretch_b) {
    return 2 / (stretch_a * std::abs(b.z) + stretch_b * std::abs(a.z));
  }

  // A normal (z > 0) with density G1(w) D(m) |w.m| / |w.z| per solid angle: those visible from w, on
  // either side.
  // (Heitz 2018; by spherical caps, Dupuy and Benyoub 2023.)
  Vec3 SampleVisibleNormal(Vec3 w, Point2 u) const {
    if (w.z < 0) w = -w;
    return NormalFromCap(Normalize({alpha_x_ * w.x, alpha_y_ * w.y, w.z}), 1, u);
  }

  // A normal whose reflection of wo (wo.z > 0) is likely above the surface: the cap of visible normals
  // without most of those that reflect downwards. (Eto and Tokuyoshi 2023, "Bounded VNDF Sampling for
  // Smith-GGX Reflections".)
  Vec3 SampleReflectingNormal(Vec3 wo, Point2 u) const {
    return NormalFromCap(Normalize({alpha_x_ * wo.x, alpha_y_ * wo.y, wo.z}), CapBound(wo), u);
  }
  // Density per solid angle of the direction wi that SampleReflectingNormal reflects to, where wi is above
  // the surface. d is D of the half vector, stretch_o is Stretch(wo).
  float ReflectionPdf(Vec3 wo, float d, float stretch_o) const {
    return d / (2 * (CapBound(wo) * wo.z + stretch_o));
  }

 private:
  // k of Eto and Tokuyoshi, equation 5.
  float CapBound(Vec3 wo) const {
    const float a2 = Sqr(std::min({alpha_x_, alpha_y_, 1.0f}));
    const float s2 = Sqr(1 + std::sqrt(wo.x * wo.x + wo.y * wo.y));
    return (1 - a2) * s2 / (s2 + a2 * wo.z * wo.z);
  }
  // The half vector of the stretched w and a point of the cap z >= -bound * w.z of the unit sphere,
  // unstretched.
  Vec3 NormalFromCap(Vec3 stretched, float bound, Point2 u) const {
    const float b = bound * stretched.z;
    const float z = (1 - u.y) * (1 + b) - b;
    const float r = SafeSqrt(1 - z * z);
    const float phi = 2 * kPi * u.x;
    const Vec3 m{stretched.x + r * std::cos(phi), stretched.y + r * std::sin(phi), stretched.z + z};
    const Vec3 n{alpha_x_ * m.x, alpha_y_ * m.y, std::max(m.z, 1e-6f)};
    return Normalize(n);
  }

  float alpha_x_ = 0, alpha_y_ = 0;
  float inverse_x_ = 0, inverse_y_ = 0;
  bool smooth_ = true;
};

}  // namespace tessera
