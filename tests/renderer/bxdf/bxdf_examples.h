// BxDFs of every kind, smooth and rough, for tests of properties that all of them have.
#pragma once

#include <string>
#include <vector>

#include "renderer/bxdf/bxdf.h"
#include "tests/renderer/bxdf/measured_tables.h"

namespace tessera {

struct BxdfExample {
  std::string name;
  Bxdf bxdf;
};

inline SampledSpectrum FourColors() {
  return {0.9f, 0.6f, 0.3f, 0.1f};
}

// The tables of the coats, alive for the whole program.
inline const CoatTable& TestCoat(float alpha, float thickness) {
  static CoatTableCache cache;
  static std::vector<std::shared_ptr<const CoatTable>> alive;
  alive.push_back(cache.Constant(alpha, 1.5f, thickness));
  return *alive.back();
}

inline DielectricBxdf TestInterface(float alpha_x, float alpha_y, float eta) {
  return {MicrofacetDistribution(alpha_x, alpha_y), eta};
}

inline CoatedDiffuseBxdf TestCoated(float alpha, SampledSpectrum reflectance, float thickness = 0.01f,
                                    int base_hits = 5) {
  return {TestInterface(alpha, alpha, 1.5f), TestCoat(alpha, thickness).At(0), reflectance, base_hits};
}

inline CoatLayer TestLayer(float thickness, float albedo, float g) {
  CoatLayer layer;
  layer.thickness = thickness;
  layer.albedo = SampledSpectrum(albedo);
  layer.g = g;
  return layer;
}

// Copper-like at the first wavelengths, darker at the last.
inline LayeredConductorBxdf TestCoatedMetal(float alpha_coat, float alpha_metal, const CoatLayer& layer,
                                            float eta = 1.5f) {
  const SampledSpectrum metal_eta(0.2f, 0.9f, 1.1f, 1.5f), metal_k(3.9f, 2.4f, 2.1f, 1.0f);
  return {TestInterface(alpha_coat, alpha_coat, eta), MicrofacetDistribution(alpha_metal, alpha_metal),
          metal_eta, metal_k, layer};
}

// Hair hit at h across its width.
inline HairBxdf TestHair(float h, float beta_m, float beta_n, float alpha = 2) {
  return {HairFibre(1.55f, beta_m, beta_n, alpha), h, SampledSpectrum(0.05f, 0.2f, 0.6f, 2.0f)};
}

// Alive for the whole program.
inline MeasuredBxdf TestMeasured(bool is_isotropic) {
  static const MeasuredBrdf isotropic = MakeMeasuredBrdf(MeasureMetal({0.4f, 0.4f}, true, 32));
  static const MeasuredBrdf brushed = MakeMeasuredBrdf(MeasureMetal({0.3f, 0.6f}, false, 32));
  return {is_isotropic ? isotropic : brushed, {420, 500, 600, 690}};
}

// Kinds with a density: everything but mirrors and panes.
inline std::vector<BxdfExample> RoughExamples() {
  const SampledSpectrum eta(0.2f, 0.9f, 1.1f, 1.5f), k(3.9f, 2.4f, 2.1f, 0.0f);
  return {
      {"diffuse", DiffuseBxdf(FourColors())},
      {"diffuse transmission", DiffuseTransmissionBxdf(FourColors() * 0.5f, FourColors() * 0.25f)},
      {"rough conductor", ConductorBxdf({0.3f, 0.3f}, eta, k)},
      {"very rough conductor", ConductorBxdf({1, 1}, eta, k)},
      {"brushed conductor", ConductorBxdf({0.1f, 0.5f}, eta, k)},
      {"rough glass", TestInterface(0.3f, 0.3f, 1.5f)},
      {"rough bubble", TestInterface(0.4f, 0.4f, 0.7f)},
      {"brushed glass", TestInterface(0.2f, 0.6f, 1.33f)},
      {"smooth coat", TestCoated(0, FourColors())},
      {"rough coat", TestCoated(0.3f, FourColors())},
      {"walked coat",
       LayeredDiffuseBxdf(TestInterface(0.3f, 0.3f, 1.5f), FourColors(), TestLayer(0.1f, 0.5f, 0.3f))},
      {"walked brushed coat",
       LayeredDiffuseBxdf(TestInterface(0.2f, 0.4f, 1.5f), FourColors(), TestLayer(0.01f, 0, 0))},
      {"walked metal under a smooth coat", TestCoatedMetal(0, 0.3f, TestLayer(0.01f, 0, 0))},
      {"walked metal under a rough coat", TestCoatedMetal(0.3f, 0.2f, TestLayer(0.1f, 0, 0))},
      {"walked mirror under a rough coat", TestCoatedMetal(0.4f, 0, TestLayer(0.01f, 0, 0))},
      {"walked mirror under a milky layer", TestCoatedMetal(0, 0, TestLayer(0.5f, 0.8f, 0.4f))},
      {"walked metal under a thin gas", TestCoatedMetal(0.3f, 0.3f, TestLayer(0.01f, 0, 0), 0.8f)},
      {"measured metal", TestMeasured(true)},
      {"measured brushed metal", TestMeasured(false)},
      {"hair", TestHair(0.3f, 0.3f, 0.3f)},
      {"rough hair", TestHair(-0.8f, 0.9f, 0.9f)},
      {"hair with large scales", TestHair(0.1f, 0.25f, 0.4f, 12)},
  };
}

inline std::vector<BxdfExample> SpecularExamples() {
  return {
      {"mirror", ConductorBxdf({}, SampledSpectrum(0.2f), SampledSpectrum(3.9f))},
      {"mirror under a clear coat", TestCoatedMetal(0, 0, TestLayer(0.01f, 0, 0))},
      {"glass", TestInterface(0, 0, 1.5f)},
      {"bubble", TestInterface(0, 0, 0.7f)},
      {"nothing", TestInterface(0.3f, 0.3f, 1)},
      {"pane", ThinDielectricBxdf(1.5f)},
  };
}

// A unit direction of this cosine with the normal.
inline Vec3 DirectionAt(float cos_theta, float phi) {
  const float r = SafeSqrt(1 - cos_theta * cos_theta);
  return {r * std::cos(phi), r * std::sin(phi), cos_theta};
}

}  // namespace tessera
