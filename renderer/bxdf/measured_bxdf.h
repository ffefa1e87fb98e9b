// Reflection that was measured (Dupuy and Jakob 2018): tables over directions that are warped so that they
// resolve the peak of each material.
#pragma once

#include <optional>

#include "renderer/bxdf/bxdf_sample.h"
#include "renderer/bxdf/warp_2d.h"

namespace tessera {

// The tables of one material. Places on them are directions by u = sqrt(2 theta / pi), v = phi / (2 pi) + 1/2
// or what the warps make of these; parameters are azimuth and polar angle of wo in radians, then the
// wavelength in nm. Immutable.
struct MeasuredBrdf {
  Warp2D<0> ndf, sigma;       // microfacet normals per solid angle; their projected area
  Warp2D<2> vndf, luminance;  // visible normals; what is left for sampling after these
  Warp2D<3> spectra;
  bool is_isotropic = false;  // then azimuths of normals are relative to that of wo
};

class MeasuredBxdf {
 public:
  // `brdf` must outlive this. lambda: the wavelengths of the path, in nm.
  MeasuredBxdf(const MeasuredBrdf& brdf, Float4 lambda) : brdf_(&brdf), lambda_(lambda) {}

  BxdfFlags flags() const { return BxdfFlags::kReflection | BxdfFlags::kGlossy; }
  // As reciprocal as the measurement.
  BsdfEvaluation Evaluate(Vec3 wo, Vec3 wi) const;
  std::optional<BsdfSample> Sample(Vec3 wo, float uc, Point2 u) const;

 private:
  BsdfEvaluation EvaluateAbove(Vec3 wo, Vec3 wi) const;

  const MeasuredBrdf* brdf_;
  Float4 lambda_;
};

}  // namespace tessera
