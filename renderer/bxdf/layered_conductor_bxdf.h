// A metal under a coat whose layer may scatter light. If coat and metal are smooth and the layer is clear,
// all light leaves in the mirror direction, and the geometric series of reflections between the two has a
// closed form. Everything else is estimated by a random walk between them (layer_walk.h).
#pragma once

#include <optional>

#include "renderer/bxdf/bxdf_sample.h"
#include "renderer/bxdf/coat_layer.h"
#include "renderer/bxdf/dielectric_bxdf.h"

namespace tessera {

class LayeredConductorBxdf {
 public:
  // Index eta + i k of the metal relative to that of the coat.
  LayeredConductorBxdf(const DielectricBxdf& coat, const MicrofacetDistribution& facets, SampledSpectrum eta,
                       SampledSpectrum k, const CoatLayer& layer)
      : layer_(layer),
        eta_(eta),
        k_(k),
        coat_(coat),
        alpha_x_(facets.alpha_x()),
        alpha_y_(facets.alpha_y()) {}

  BxdfFlags flags() const;
  // f is an unbiased estimate, always the same for the same two directions; pdf is exact.
  BsdfEvaluation Evaluate(Vec3 wo, Vec3 wi) const;
  // The f of a sample is an unbiased estimate, exact if the sample is specular.
  std::optional<BsdfSample> Sample(Vec3 wo, float uc, Point2 u) const;

 private:
  // The probabilities with which Sample chooses a lobe at wo; what remains is a cosine lobe.
  struct Choice {
    float mirror = 0;  // the reflection of the coat, and of the metal if both are smooth
    float metal = 0;   // the metal seen through the coat
  };
  MicrofacetDistribution facets() const { return {alpha_x_, alpha_y_}; }
  // Whether both interfaces are smooth, so that only the layer can spread light.
  bool HasSmoothInterfaces() const { return coat_.IsSpecular() && facets().IsSmooth(); }
  bool IsSpecular() const { return HasSmoothInterfaces() && !AnyNonZero(layer_.albedo); }
  SampledSpectrum MirrorReflectance(float cos_o) const;
  Choice ChoiceAt(Vec3 wo) const;
  BsdfEvaluation EvaluateAbove(Vec3 wo, Vec3 wi, const Choice& choice) const;
  std::optional<BsdfSample> SampleAbove(Vec3 wo, float uc, Point2 u) const;

  CoatLayer layer_;
  SampledSpectrum eta_, k_;
  DielectricBxdf coat_;
  float alpha_x_, alpha_y_;  // of the metal
};

}  // namespace tessera
