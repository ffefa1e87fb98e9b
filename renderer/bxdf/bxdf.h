// One BxDF of any kind, as a value.
#pragma once

#include <optional>
#include <type_traits>
#include <variant>

#include "renderer/bxdf/bxdf_sample.h"
#include "renderer/bxdf/coated_diffuse_bxdf.h"
#include "renderer/bxdf/conductor_bxdf.h"
#include "renderer/bxdf/dielectric_bxdf.h"
#include "renderer/bxdf/diffuse_bxdf.h"
#include "renderer/bxdf/diffuse_transmission_bxdf.h"
#include "renderer/bxdf/hair_bxdf.h"
#include "renderer/bxdf/layered_conductor_bxdf.h"
#include "renderer/bxdf/layered_diffuse_bxdf.h"
#include "renderer/bxdf/measured_bxdf.h"
#include "renderer/bxdf/normalized_fresnel_bxdf.h"
#include "renderer/bxdf/thin_dielectric_bxdf.h"
#include "renderer/util/dispatch.h"

namespace tessera {

// Every kind has the members flags, Evaluate and Sample of Bxdf below and is trivially copyable. One that has
// both diffuse and glossy lobes has DiffuseShare, too; one of a single glossy lobe may have Lobe.
using BxdfKind = std::variant<DiffuseBxdf, DiffuseTransmissionBxdf, ConductorBxdf, DielectricBxdf,
                              ThinDielectricBxdf, CoatedDiffuseBxdf, LayeredDiffuseBxdf, LayeredConductorBxdf,
                              HairBxdf, MeasuredBxdf, NormalizedFresnelBxdf>;
static_assert(std::is_trivially_copyable_v<BxdfKind>);
// Every vertex of every path copies one: a larger kind would slow all others down.
static_assert(sizeof(BxdfKind) <= 112);

// Directions are unit vectors in the shading frame, where z is the normal. They point away from the surface,
// and wo.z != 0. Cheap to copy; owns nothing.
class Bxdf {
 public:
  Bxdf() = default;  // absorbs everything
  template <AlternativeOf<BxdfKind> Kind>
  Bxdf(const Kind& kind) : kind_(kind) {}

  [[gnu::always_inline]] BxdfFlags flags() const {
    return Dispatch(kind_, [](const auto& kind) { return kind.flags(); });
  }

  // Value and density of the non-specular lobes together.
  BsdfEvaluation Evaluate(Vec3 wo, Vec3 wi) const {
    return Dispatch(kind_, [&](const auto& kind) -> BsdfEvaluation { return kind.Evaluate(wo, wi); });
  }

  // Of the light that Evaluate reflects from wi to wo: the share of the diffuse lobes. wo and wi are on the
  // same side.
  SampledSpectrum DiffuseShare(Vec3 wo, Vec3 wi) const {
    return Dispatch(kind_, [&](const auto& kind) -> SampledSpectrum {
      if constexpr (requires { kind.DiffuseShare(wo, wi); }) return kind.DiffuseShare(wo, wi);
      return SampledSpectrum(HasFlag(kind.flags(), BxdfFlags::kDiffuse) ? 1.0f : 0.0f);
    });
  }

  // The lobe around the reflection of wo, of a kind that scatters all light into one; else one of roughness
  // 0.
  GlossyLobe Lobe(Vec3 wo) const {
    return Dispatch(kind_, [&](const auto& kind) -> GlossyLobe {
      if constexpr (requires { kind.Lobe(wo); }) return kind.Lobe(wo);
      return {};
    });
  }

  // uc chooses the lobe, u the direction. A sample that is not specular has the f and pdf that Evaluate
  // returns.
  std::optional<BsdfSample> Sample(Vec3 wo, float uc, Point2 u) const {
    return Dispatch(kind_,
                    [&](const auto& kind) -> std::optional<BsdfSample> { return kind.Sample(wo, uc, u); });
  }

 private:
  BxdfKind kind_;
};

}  // namespace tessera
