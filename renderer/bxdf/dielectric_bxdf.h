// Glass, water, varnish: an interface between two transparent media, smooth or of microfacets (Walter et al.
// 2007).
#pragma once

#include <optional>

#include "renderer/bxdf/bxdf_sample.h"
#include "renderer/bxdf/microfacet.h"

namespace tessera {

class DielectricBxdf {
 public:
  // eta: the index of refraction below the surface relative to that above.
  DielectricBxdf(const MicrofacetDistribution& facets, float eta) : facets_(facets), eta_(eta) {}

  const MicrofacetDistribution& facets() const { return facets_; }
  float eta() const { return eta_; }
  bool IsSpecular() const { return facets_.IsSmooth() || eta_ == 1; }
  BxdfFlags flags() const {
    const BxdfFlags width = IsSpecular() ? BxdfFlags::kSpecular : BxdfFlags::kGlossy;
    if (eta_ == 1) return BxdfFlags::kTransmission | width;
    return BxdfFlags::kReflection | BxdfFlags::kTransmission | width;
  }

  // Zero if specular, or for a lobe that is not in `lobes`. The density is that of Sample with the same
  // lobes.
  BsdfEvaluation Evaluate(Vec3 wo, Vec3 wi, TransportMode mode = TransportMode::kRadiance,
                          Lobes lobes = Lobes::kBoth) const;
  // Chooses reflection or transmission in proportion to the Fresnel term, among `lobes`.
  std::optional<BsdfSample> Sample(Vec3 wo, float uc, Point2 u, TransportMode mode = TransportMode::kRadiance,
                                   Lobes lobes = Lobes::kBoth) const;

 private:
  std::optional<BsdfSample> SampleSpecular(Vec3 wo, float uc, TransportMode mode, Lobes lobes) const;

  MicrofacetDistribution facets_;
  float eta_;
};

// Of the light that a diffuse surface under a coat reflects from wi to wo, both above: the share that is not
// the coat's reflection. `f` is the value of both.
SampledSpectrum DiffuseShareOf(const DielectricBxdf& coat, Vec3 wo, Vec3 wi, SampledSpectrum f);

}  // namespace tessera
