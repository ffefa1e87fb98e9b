// A Lambertian base under a coat whose layer may scatter light, estimated by a random walk between the layers
// (layer_walk.h). For the coats for which coated_diffuse_bxdf.h has no closed form.
#pragma once

#include <optional>

#include "renderer/bxdf/bxdf_sample.h"
#include "renderer/bxdf/coat_layer.h"
#include "renderer/bxdf/dielectric_bxdf.h"

namespace tessera {

class LayeredDiffuseBxdf {
 public:
  LayeredDiffuseBxdf(const DielectricBxdf& coat, SampledSpectrum reflectance, const CoatLayer& layer)
      : reflectance_(reflectance), layer_(layer), coat_(coat) {}

  BxdfFlags flags() const {
    const BxdfFlags coat = coat_.IsSpecular() ? BxdfFlags::kSpecular : BxdfFlags::kGlossy;
    return BxdfFlags::kReflection | BxdfFlags::kDiffuse | coat;
  }
  // f is an unbiased estimate, always the same for the same two directions; pdf is exact.
  BsdfEvaluation Evaluate(Vec3 wo, Vec3 wi) const;
  // The f of a sample is an unbiased estimate.
  std::optional<BsdfSample> Sample(Vec3 wo, float uc, Point2 u) const;
  // Of f at two directions on the same side: the share of what is not the reflection of the coat.
  SampledSpectrum DiffuseShare(Vec3 wo, Vec3 wi) const;

  // One walk from wo to wi (both above): all of f except the reflection of the coat. Its random numbers are a
  // function of `seed`.
  SampledSpectrum EstimateWalk(Vec3 wo, Vec3 wi, uint64_t seed) const;

 private:
  BsdfEvaluation EvaluateAbove(Vec3 wo, Vec3 wi) const;
  std::optional<BsdfSample> SampleAbove(Vec3 wo, float uc, Point2 u) const;
  float CoatProbability(Vec3 wo) const;

  SampledSpectrum reflectance_;
  CoatLayer layer_;
  DielectricBxdf coat_;
};

}  // namespace tessera
