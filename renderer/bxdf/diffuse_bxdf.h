// Lambertian reflection: the same radiance in every direction of the side of the light.
#pragma once

#include <optional>

#include "renderer/bxdf/bxdf_sample.h"
#include "renderer/math/sampling.h"

namespace tessera {

class DiffuseBxdf {
 public:
  DiffuseBxdf() = default;  // black
  explicit DiffuseBxdf(SampledSpectrum reflectance) : f_(reflectance * kInvPi) {}

  BxdfFlags flags() const {
    return AnyNonZero(f_) ? BxdfFlags::kReflection | BxdfFlags::kDiffuse : BxdfFlags::kNone;
  }
  BsdfEvaluation Evaluate(Vec3 wo, Vec3 wi) const {
    if (!SameHemisphere(wo, wi)) return {};
    return {f_, CosineHemispherePdf(AbsCosTheta(wi))};
  }
  std::optional<BsdfSample> Sample(Vec3 wo, float /*uc*/, Point2 u) const {
    Vec3 wi = SampleCosineHemisphere(u);
    wi.z = std::copysign(wi.z, wo.z);  // without a branch, which could not be predicted
    return BsdfSample{f_, wi, CosineHemispherePdf(AbsCosTheta(wi)),
                      BxdfFlags::kReflection | BxdfFlags::kDiffuse, 1};
  }

 private:
  SampledSpectrum f_;
};

}  // namespace tessera
