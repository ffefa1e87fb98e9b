// Light scattered evenly to both sides: paper, leaves.
#pragma once

#include <optional>

#include "renderer/bxdf/bxdf_sample.h"
#include "renderer/math/sampling.h"

namespace tessera {

class DiffuseTransmissionBxdf {
 public:
  DiffuseTransmissionBxdf() = default;  // black
  DiffuseTransmissionBxdf(SampledSpectrum reflectance, SampledSpectrum transmittance)
      : reflected_(reflectance * kInvPi), transmitted_(transmittance * kInvPi) {
    const float r = MaxElement(reflectance), t = MaxElement(transmittance);
    reflection_probability_ = r > 0 ? r / (r + t) : 0;
    black_ = !(r + t > 0);
  }

  BxdfFlags flags() const {
    BxdfFlags flags = BxdfFlags::kNone;
    if (AnyNonZero(reflected_)) flags = flags | BxdfFlags::kReflection | BxdfFlags::kDiffuse;
    if (AnyNonZero(transmitted_)) flags = flags | BxdfFlags::kTransmission | BxdfFlags::kDiffuse;
    return flags;
  }
  BsdfEvaluation Evaluate(Vec3 wo, Vec3 wi) const {
    if (black_) return {};
    const float pdf = CosineHemispherePdf(AbsCosTheta(wi));
    if (SameHemisphere(wo, wi)) return {reflected_, pdf * reflection_probability_};
    return {transmitted_, pdf * (1 - reflection_probability_)};
  }
  std::optional<BsdfSample> Sample(Vec3 wo, float uc, Point2 u) const {
    if (black_) return std::nullopt;
    const bool reflect = uc < reflection_probability_;
    Vec3 wi = SampleCosineHemisphere(u);
    if ((wo.z < 0) == reflect) wi.z = -wi.z;
    const BsdfEvaluation value = Evaluate(wo, wi);
    const BxdfFlags side = reflect ? BxdfFlags::kReflection : BxdfFlags::kTransmission;
    return BsdfSample{value.f, wi, value.pdf, side | BxdfFlags::kDiffuse, 1};
  }

 private:
  SampledSpectrum reflected_, transmitted_;
  float reflection_probability_ = 0;
  bool black_ = true;
};

}  // namespace tessera
