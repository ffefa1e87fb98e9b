// How a surface scatters light at one point: a BxDF and its shading frame.
#pragma once

#include <concepts>
#include <optional>

#include "renderer/bxdf/bxdf.h"
#include "renderer/math/vec.h"

namespace tessera {

// The BSDF at one point. Directions are unit vectors in rendering space that point away from the surface.
// Always for the transport of radiance, not of importance. A plain value that owns nothing.
class Bsdf {
 public:
  Bsdf() = default;
  // Of a BxDF that depends on azimuths only through their difference.
  Bsdf(Normal3 shading_n, const Bxdf& isotropic) : frame_(Frame::FromZ(shading_n)), bxdf_(isotropic) {}
  // Of the BxDF that `make` returns. It is not copied: a copy would wait for the stores of its parts.
  template <std::invocable Make>
  Bsdf(const Frame& frame, Make&& make) : frame_(frame), bxdf_(make()) {}
  // shading_n and dpdu as in SurfaceInteraction::shading after bump mapping.
  Bsdf(Normal3 shading_n, Vec3 dpdu, const Bxdf& bxdf)
      : frame_(Frame::FromXZ(dpdu, shading_n)), bxdf_(bxdf) {}

  [[gnu::always_inline]] BxdfFlags flags() const { return bxdf_.flags(); }
  [[gnu::always_inline]] bool HasNonSpecular() const {
    const BxdfFlags lobes = flags();
    return HasFlag(lobes, BxdfFlags::kDiffuse) || HasFlag(lobes, BxdfFlags::kGlossy);
  }
  // Both zero for specular components.
  BsdfEvaluation Evaluate(Vec3 wo, Vec3 wi) const {
    const Vec3 wo_local = frame_.ToLocal(wo), wi_local = frame_.ToLocal(wi);
    if (wo_local.z == 0) return {};
    return bxdf_.Evaluate(wo_local, wi_local);
  }
  // Whether light from wi to wo is reflected, as seen from the shading normal, rather than transmitted.
  bool IsReflection(Vec3 wo, Vec3 wi) const { return SameHemisphere(frame_.ToLocal(wo), frame_.ToLocal(wi)); }
  // Of light that is reflected from wi to wo by what is not specular: the share of the diffuse lobes.
  SampledSpectrum DiffuseShare(Vec3 wo, Vec3 wi) const {
    return bxdf_.DiffuseShare(frame_.ToLocal(wo), frame_.ToLocal(wi));
  }
  // As Bxdf::Lobe.
  GlossyLobe Lobe(Vec3 wo) const {
    GlossyLobe lobe = bxdf_.Lobe(frame_.ToLocal(wo));
    if (lobe.alpha_squared > 0) lobe.axis = frame_.FromLocal(lobe.axis);
    return lobe;
  }
  // uc chooses the component, u the direction. Returns nullopt if the light is absorbed.
  [[gnu::always_inline]] std::optional<BsdfSample> Sample(Vec3 wo, float uc, Point2 u) const {
    const Vec3 wo_local = frame_.ToLocal(wo);
    // One variable is returned, so that it is not copied: a copy would wait for the stores of its parts.
    std::optional<BsdfSample> sample = wo_local.z != 0 ? bxdf_.Sample(wo_local, uc, u) : std::nullopt;
    if (sample && sample->pdf > 0 && AnyNonZero(sample->f) && sample->wi.z != 0) {
      sample->wi = frame_.FromLocal(sample->wi);
    } else {
      sample.reset();
    }
    return sample;
  }

 private:
  Frame frame_;
  Bxdf bxdf_;
};

}  // namespace tessera
