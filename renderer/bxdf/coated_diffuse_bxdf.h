// A Lambertian base under a clear coat, in closed form.
//
// Because the base does not depend on the direction that light came from, pbrt-v4's random walk between the
// layers (LayeredBxDF) sums to
//   f = f_coat + T(wo) T(wi) (rho / (pi eta^2)) (1 + rho R + ... + (rho R)^(n-1)),
// where T and R are the transmittance and the internal reflectance of the coat (coat_table.h), rho is the
// reflectance of the base and n the number of times that the walk may reach it. (The sum over n is
// Saunderson's, 1942.) pbrt-v4's LayeredBxDF::f, which light sampling uses there, weights its two ways out of
// the layer by densities of opposite directions, so that the weights of rough coats sum to a little over 1;
// its Sample_f does not. The f here is reciprocal and the same for all sampling techniques.
#pragma once

#include <optional>

#include "renderer/bxdf/bxdf_sample.h"
#include "renderer/bxdf/coat_table.h"
#include "renderer/bxdf/dielectric_bxdf.h"

namespace tessera {

class CoatedDiffuseBxdf {
 public:
  // `lookup` is the row of the coat's (isotropic) alpha, its eta and thickness; the table must outlive this.
  // base_hits >= 0 is n above.
  CoatedDiffuseBxdf(const DielectricBxdf& coat, const CoatLookup& lookup, SampledSpectrum reflectance,
                    int base_hits);

  // How often a walk of pbrt-v4's `maxdepth` interface events reaches the base: every other event.
  static int BaseHits(int depth_max) { return (depth_max + 1) / 2; }

  BxdfFlags flags() const {
    const BxdfFlags coat = coat_.IsSpecular() ? BxdfFlags::kSpecular : BxdfFlags::kGlossy;
    return BxdfFlags::kReflection | BxdfFlags::kDiffuse | coat;
  }
  BsdfEvaluation Evaluate(Vec3 wo, Vec3 wi) const;
  std::optional<BsdfSample> Sample(Vec3 wo, float uc, Point2 u) const;
  // Of f at two directions on the same side: the share of what is not the reflection of the coat.
  SampledSpectrum DiffuseShare(Vec3 wo, Vec3 wi) const;

 private:
  // The probabilities with which Sample chooses at wo.
  struct Choice {
    float transmittance;     // of the coat
    float coat_probability;  // of sampling its reflection rather than the base
  };
  Choice ChoiceAt(float cos_o) const;
  // transmittance_i: of the coat at wi.
  BsdfEvaluation EvaluateAbove(Vec3 wo, Vec3 wi, const Choice& choice, float transmittance_i) const;
  std::optional<BsdfSample> SampleAbove(Vec3 wo, float uc, Point2 u) const;

  SampledSpectrum base_;  // f of the base without T(wo) T(wi)
  DielectricBxdf coat_;
  CoatLookup lookup_;
  float base_albedo_;  // mean over wavelengths of the base's albedo divided by T(wo)
};

}  // namespace tessera
