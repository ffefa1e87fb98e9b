// A pane so thin that light leaves where it entered, without refraction. Reflections between its two sides
// are summed in closed form.
#pragma once

#include <optional>

#include "renderer/bxdf/bxdf_sample.h"
#include "renderer/bxdf/fresnel.h"

namespace tessera {

class ThinDielectricBxdf {
 public:
  explicit ThinDielectricBxdf(float eta) : eta_(eta) {}

  BxdfFlags flags() const { return BxdfFlags::kReflection | BxdfFlags::kTransmission | BxdfFlags::kSpecular; }
  BsdfEvaluation Evaluate(Vec3, Vec3) const { return {}; }
  std::optional<BsdfSample> Sample(Vec3 wo, float uc, Point2 /*u*/) const {
    const float cos_o = AbsCosTheta(wo);
    float reflected = FrDielectric(cos_o, eta_);
    // R + T R T + T R R R T + ... = R + T^2 R / (1 - R^2)
    if (reflected < 1) reflected += Sqr(1 - reflected) * reflected / (1 - reflected * reflected);
    if (uc < reflected) {
      return BsdfSample{SampledSpectrum(reflected / cos_o), Vec3{-wo.x, -wo.y, wo.z}, reflected,
                        BxdfFlags::kReflection | BxdfFlags::kSpecular, 1};
    }
    const float transmitted = 1 - reflected;
    return BsdfSample{SampledSpectrum(transmitted / cos_o), -wo, transmitted,
                      BxdfFlags::kTransmission | BxdfFlags::kSpecular, 1};
  }

 private:
  float eta_;
};

}  // namespace tessera
