// The tables that a measurement of a rough metal would give, for tests of measured BRDFs.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "renderer/bxdf/measured_bxdf.h"
#include "renderer/bxdf/microfacet.h"

namespace tessera {

struct MeasuredTables {
  int resolution = 0;  // of all grids, along both sides
  std::vector<float> phi, theta, wavelengths;
  std::vector<float> ndf, sigma, vndf, luminance, spectra;
};

// Reflectance at the wavelengths 400, 550 and 700 nm.
inline constexpr float kMeasuredReflectance[] = {0.2f, 0.5f, 0.8f};

inline Vec3 DirectionOfAngles(float theta, float phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Azimuths: one if isotropic.
inline MeasuredTables MeasureMetal(const MicrofacetDistribution& facets, bool is_isotropic, int resolution) {
  MeasuredTables t;
  t.resolution = resolution;
  t.wavelengths = {400, 550, 700};
  for (int i = 0; i < 14; ++i) t.theta.push_back(1.5f * Sqr(static_cast<float>(i) / 13));
  if (is_isotropic) t.phi = {0};
  for (int i = 0; !is_isotropic && i <= 16; ++i) t.phi.push_back(kPi * (static_cast<float>(i) / 8 - 1));
  const auto at_nodes = [&](const auto& value, std::vector<float>& out) {
    for (int row = 0; row < resolution; ++row) {
      for (int column = 0; column < resolution; ++column) {
        const float u = static_cast<float>(column) / static_cast<float>(resolution - 1);
        const float v = static_cast<float>(row) / static_cast<float>(resolution - 1);
        out.push_back(value(u, u * u * kPi / 2, (2 * v - 1) * kPi));
      }
    }
  };
  const auto area = [&](float theta, float phi) {
    const Vec3 w = DirectionOfAngles(theta, phi);
    return (w.z + facets.Stretch(w)) / 2;
  };
  at_nodes([&](float, float theta, float phi) { return facets.D(DirectionOfAngles(theta, phi), 1); }, t.ndf);
  at_nodes([&](float, float theta, float phi) { return area(theta, phi); }, t.sigma);
  for (const float phi_o : t.phi) {
    for (const float theta_o : t.theta) {
      const Vec3 wo = DirectionOfAngles(theta_o, phi_o);
      const auto visible = [&](float u, float theta, float phi) {
        const Vec3 m = DirectionOfAngles(theta, phi);
        const float solid_angle = 2 * kPi * kPi * u * std::sin(theta);
        return facets.D(m, 1) * std::max(0.0f, Dot(wo, m)) / area(theta_o, phi_o) * solid_angle;
      };
      at_nodes(visible, t.vndf);
      at_nodes([](float u, float, float phi) { return 1 + 0.2f * u + 0.05f * phi; }, t.luminance);
      for (const float reflectance : kMeasuredReflectance) {
        at_nodes([&](float, float, float) { return reflectance; }, t.spectra);
      }
    }
  }
  return t;
}

inline MeasuredBrdf MakeMeasuredBrdf(const MeasuredTables& t) {
  const int n = t.resolution;
  return {Warp2D<0>::ForEvaluation({n, n, t.ndf, {}}),
          Warp2D<0>::ForEvaluation({n, n, t.sigma, {}}),
          Warp2D<2>::ForSampling({n, n, t.vndf, {t.phi, t.theta}}),
          Warp2D<2>::ForSampling({n, n, t.luminance, {t.phi, t.theta}}),
          Warp2D<3>::ForEvaluation({n, n, t.spectra, {t.phi, t.theta, t.wavelengths}}),
          t.phi.size() <= 2};
}

}  // namespace tessera
