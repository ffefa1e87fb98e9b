// One BxDF of any kind as a value: a tagged union, dispatched by a switch.
#pragma once

#include <optional>

#include "renderer/material/bxdf_sample.h"
#include "renderer/material/coated_diffuse_bxdf.h"
#include "renderer/material/conductor_bxdf.h"
#include "renderer/material/dielectric_bxdf.h"
#include "renderer/material/diffuse_bxdf.h"
#include "renderer/material/diffuse_transmission_bxdf.h"
#include "renderer/material/layered_diffuse_bxdf.h"
#include "renderer/material/thin_dielectric_bxdf.h"

namespace tessera {

// Directions are unit vectors in the shading frame (z is the normal), pointing away from the surface, wo.z !=
// 0. Cheap to copy; owns nothing.
class Bxdf {
 public:
  Bxdf() : kind_(Kind::kDiffuse), diffuse_() {}  // absorbs everything
  Bxdf(const DiffuseBxdf& b) : kind_(Kind::kDiffuse), diffuse_(b) {}
  Bxdf(const DiffuseTransmissionBxdf& b) : kind_(Kind::kDiffuseTransmission), diffuse_transmission_(b) {}
  Bxdf(const ConductorBxdf& b) : kind_(Kind::kConductor), conductor_(b) {}
  Bxdf(const DielectricBxdf& b) : kind_(Kind::kDielectric), dielectric_(b) {}
  Bxdf(const ThinDielectricBxdf& b) : kind_(Kind::kThinDielectric), thin_dielectric_(b) {}
  Bxdf(const CoatedDiffuseBxdf& b) : kind_(Kind::kCoatedDiffuse), coated_diffuse_(b) {}
  Bxdf(const LayeredDiffuseBxdf& b) : kind_(Kind::kLayeredDiffuse), layered_diffuse_(b) {}

  BxdfFlags flags() const {
    switch (kind_) {
      case Kind::kDiffuse: return diffuse_.flags();
      case Kind::kDiffuseTransmission: return diffuse_transmission_.flags();
      case Kind::kConductor: return conductor_.flags();
      case Kind::kDielectric: return dielectric_.flags();
      case Kind::kThinDielectric: return thin_dielectric_.flags();
      case Kind::kCoatedDiffuse: return coated_diffuse_.flags();
      case Kind::kLayeredDiffuse: return layered_diffuse_.flags();
    }
    return BxdfFlags::kNone;
  }

  // Value and density of the non-specular lobes together.
  BsdfEvaluation Evaluate(Vec3 wo, Vec3 wi) const {
    switch (kind_) {
      case Kind::kDiffuse: return diffuse_.Evaluate(wo, wi);
      case Kind::kDiffuseTransmission: return diffuse_transmission_.Evaluate(wo, wi);
      case Kind::kConductor: return conductor_.Evaluate(wo, wi);
      case Kind::kDielectric: return dielectric_.Evaluate(wo, wi);
      case Kind::kThinDielectric: return thin_dielectric_.Evaluate(wo, wi);
      case Kind::kCoatedDiffuse: return coated_diffuse_.Evaluate(wo, wi);
      case Kind::kLayeredDiffuse: return layered_diffuse_.Evaluate(wo, wi);
    }
    return {};
  }

  // uc chooses the lobe, u the direction. A sample that is not specular has the f and pdf that Evaluate
  // gives.
  std::optional<BsdfSample> Sample(Vec3 wo, float uc, Point2 u) const {
    switch (kind_) {
      case Kind::kDiffuse: return diffuse_.Sample(wo, u);
      case Kind::kDiffuseTransmission: return diffuse_transmission_.Sample(wo, uc, u);
      case Kind::kConductor: return conductor_.Sample(wo, u);
      case Kind::kDielectric: return dielectric_.Sample(wo, uc, u);
      case Kind::kThinDielectric: return thin_dielectric_.Sample(wo, uc);
      case Kind::kCoatedDiffuse: return coated_diffuse_.Sample(wo, uc, u);
      case Kind::kLayeredDiffuse: return layered_diffuse_.Sample(wo, uc, u);
    }
    return std::nullopt;
  }

 private:
  enum class Kind : uint8_t {
    kDiffuse,
    kDiffuseTransmission,
    kConductor,
    kDielectric,
    kThinDielectric,
    kCoatedDiffuse,
    kLayeredDiffuse,
  };
  Kind kind_;
  union {
    DiffuseBxdf diffuse_;
    DiffuseTransmissionBxdf diffuse_transmission_;
    ConductorBxdf conductor_;
    DielectricBxdf dielectric_;
    ThinDielectricBxdf thin_dielectric_;
    CoatedDiffuseBxdf coated_diffuse_;
    LayeredDiffuseBxdf layered_diffuse_;
  };
};

}  // namespace tessera
