// Where light enters a surface below which it is scattered: a Lambertian lobe times the transmittance of the
// interface, scaled so that a uniform environment gives 1 (Pharr, Jakob, Humphreys 2016, section 11.4.2).
#pragma once

#include <optional>

#include "renderer/bxdf/bxdf_sample.h"
#include "renderer/bxdf/fresnel.h"
#include "renderer/math/sampling.h"

namespace tessera {

class NormalizedFresnelBxdf {
 public:
  // eta: below over above. transmittance: the mean transmittance of diffuse light,
  // HemisphericalTransmittance(eta), computed once per material.
  NormalizedFresnelBxdf(float eta, float transmittance) : eta_(eta), scale_(kInvPi / transmittance) {}

  // The integral of 2 cos (1 - FrDielectric(cos, eta)) over cos from 0 to 1.
  static float HemisphericalTransmittance(float eta) {
    constexpr int kSteps = 1000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      const float cosine = (static_cast<float>(i) + 0.5f) / kSteps;
      sum += static_cast<double>(2 * cosine * (1 - FrDielectric(cosine, eta)));
    }
    return static_cast<float>(sum / kSteps);
  }

  BxdfFlags flags() const { return BxdfFlags::kReflection | BxdfFlags::kDiffuse; }
  BsdfEvaluation Evaluate(Vec3 wo, Vec3 wi) const {
    if (!SameHemisphere(wo, wi)) return {};
    const float cosine = AbsCosTheta(wi);
    return {SampledSpectrum((1 - FrDielectric(cosine, eta_)) * scale_), CosineHemispherePdf(cosine)};
  }
  std::optional<BsdfSample> Sample(Vec3 wo, float /*uc*/, Point2 u) const {
    Vec3 wi = SampleCosineHemisphere(u);
    if (!(wi.z > 0)) return std::nullopt;
    if (wo.z < 0) wi.z = -wi.z;
    const BsdfEvaluation value = Evaluate(wo, wi);
    return BsdfSample{value.f, wi, value.pdf, BxdfFlags::kReflection | BxdfFlags::kDiffuse, 1};
  }

 private:
  float eta_, scale_;
};

}  // namespace tessera
