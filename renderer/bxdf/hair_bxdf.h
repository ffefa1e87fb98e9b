// Hair and fur: a rough dielectric cylinder that absorbs light inside (Marschner et al. 2003; d'Eon et al.
// 2011; Chiang, Bitterli, Tappan, Burley, "A Practical and Controllable Hair and Fur Model for Production
// Path Tracing", 2016; Pharr, Jakob, Humphreys 2023, section 9.9). In the shading frame x runs along the hair
// and z is the normal of its width.
#pragma once

#include <array>
#include <optional>

#include "renderer/bxdf/bxdf_sample.h"

namespace tessera {

// What the hairs of one material have in common.
class HairFibre {
 public:
  static constexpr float kBetaMin = 0.01f, kBetaMax = 1;  // as pbrt-v4 clamps them
  static constexpr float kEtaMin = 0.1f, kEtaMax = 100;   // no fibre is near them; keep quotients finite

  // eta: index of refraction; beta_m, beta_n: longitudinal and azimuthal roughness; alpha: the angle of the
  // scales in degrees. Any values are allowed, as textures may hold them.
  HairFibre(float eta, float beta_m, float beta_n, float alpha);

  float eta() const { return eta_; }

 private:
  friend class HairBxdf;
  float eta_;
  float variance_;                            // longitudinal, of reflection without entering
  std::array<float, 3> log_normalization_;    // of the longitudinal lobes
  float scale_;                               // of the logistic distribution of azimuths
  float logistic_total_;                      // its integral over a full turn
  std::array<float, 3> sin_tilt_, cos_tilt_;  // of alpha, 2 alpha and 4 alpha
};

class HairBxdf {
 public:
  // h: where the hair is hit across its width, from -1 to 1 (clamped). sigma_a: absorption per radius of the
  // hair, not negative.
  HairBxdf(const HairFibre& fibre, float h, SampledSpectrum sigma_a);

  BxdfFlags flags() const { return BxdfFlags::kReflection | BxdfFlags::kTransmission | BxdfFlags::kGlossy; }
  // Not reciprocal: attenuation depends on wo alone.
  BsdfEvaluation Evaluate(Vec3 wo, Vec3 wi) const;
  std::optional<BsdfSample> Sample(Vec3 wo, float uc, Point2 u) const;

  // The sigma_a of hairs of which many together look like `reflectance` (Chiang et al., equation 9).
  static SampledSpectrum AbsorptionOfReflectance(SampledSpectrum reflectance, float beta_n);

 private:
  // Paths inside the hair by their number of segments: none (R), one (TT), two (TRT), more.
  static constexpr int kLobes = 4;

  // A direction by its angle to the plane across the hair and the angle around the hair.
  struct HairAngles {
    float sin_theta, cos_theta, phi;
    explicit HairAngles(Vec3 w);
    HairAngles(float sin_theta, float phi);
  };
  // What depends on wo alone.
  struct Lobes {
    HairAngles o;
    float gamma_t;  // angle of the refracted ray to the normal, in the plane across the hair
    std::array<SampledSpectrum, kLobes> attenuation;
    std::array<float, kLobes> probability;
  };
  Lobes LobesAt(Vec3 wo) const;
  // wo turned by the tilt of the scales as lobe p sees it.
  HairAngles Tilted(const HairAngles& o, int p) const;
  float Variance(int p) const;
  float Longitudinal(const HairAngles& i, const HairAngles& o, int p) const;
  // The angle around the hair by which smooth scattering turns light.
  float Turn(int p, float gamma_t) const;
  float Azimuthal(float phi, int p, float gamma_t) const;
  float SampleAzimuth(float u) const;
  // f is multiplied by the cosine of wi to the normal.
  BsdfEvaluation EvaluateLobes(const Lobes& lobes, const HairAngles& i) const;

  SampledSpectrum sigma_a_;
  HairFibre fibre_;
  float h_, gamma_o_;
};

}  // namespace tessera
