// Metals: a smooth mirror or rough microfacets, with the Fresnel term of a complex index of refraction.
#pragma once

#include <optional>

#include "renderer/bxdf/bxdf_sample.h"
#include "renderer/bxdf/fresnel.h"
#include "renderer/bxdf/microfacet.h"
#include "renderer/math/glossy_lobe.h"

namespace tessera {

class ConductorBxdf {
 public:
  // Index eta + i k at the four wavelengths, relative to the outside.
  ConductorBxdf(const MicrofacetDistribution& facets, SampledSpectrum eta, SampledSpectrum k)
      : eta_(eta), k_(k), facets_(facets) {}

  BxdfFlags flags() const {
    return BxdfFlags::kReflection | (facets_.IsSmooth() ? BxdfFlags::kSpecular : BxdfFlags::kGlossy);
  }
  // Around the mirror direction of wo.
  GlossyLobe Lobe(Vec3 wo) const { return {{-wo.x, -wo.y, wo.z}, facets_.alpha_x() * facets_.alpha_y()}; }
  // What a facet reflects of light at this cosine to its normal.
  SampledSpectrum Fresnel(float cos_theta) const { return FrConductor(cos_theta, eta_, k_); }
  BsdfEvaluation Evaluate(Vec3 wo, Vec3 wi) const {
    if (facets_.IsSmooth() || !SameHemisphere(wo, wi)) return {};
    if (wo.z < 0) return EvaluateAbove(-wo, -wi);
    return EvaluateAbove(wo, wi);
  }
  std::optional<BsdfSample> Sample(Vec3 wo, float /*uc*/, Point2 u) const {
    if (facets_.IsSmooth()) return SampleMirror(wo);
    const Vec3 above = wo.z < 0 ? -wo : wo;
    const Vec3 wi = Reflect(above, facets_.SampleReflectingNormal(above, u));
    if (!(wi.z > 0)) return std::nullopt;
    const BsdfEvaluation value = EvaluateAbove(above, wi);
    return BsdfSample{value.f, wo.z < 0 ? -wi : wi, value.pdf, BxdfFlags::kReflection | BxdfFlags::kGlossy,
                      1};
  }

 private:
  // R. Cook and K. Torrance, "A Reflectance Model for Computer Graphics", 1982. Both directions are above the
  // surface. The half vector is not normalised: |h| = 2 wo.m.
  BsdfEvaluation EvaluateAbove(Vec3 wo, Vec3 wi) const {
    const Vec3 h = wo + wi;
    const float length2 = LengthSquared(h);
    const float d = facets_.D(h, length2);
    const float stretch_o = facets_.Stretch(wo);
    const float g = MicrofacetDistribution::G2OverCosines(wo, stretch_o, wi, facets_.Stretch(wi));
    const SampledSpectrum fresnel = FrConductor(0.5f * std::sqrt(length2), eta_, k_);
    return {fresnel * (0.25f * d * g), facets_.ReflectionPdf(wo, d, stretch_o)};
  }
  BsdfSample SampleMirror(Vec3 wo) const {
    const float cos_o = AbsCosTheta(wo);
    return {FrConductor(cos_o, eta_, k_) / cos_o, Vec3{-wo.x, -wo.y, wo.z}, 1,
            BxdfFlags::kReflection | BxdfFlags::kSpecular, 1};
  }

  SampledSpectrum eta_, k_;
  MicrofacetDistribution facets_;
};

}  // namespace tessera
