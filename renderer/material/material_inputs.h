// The inputs that several kinds of material share, and where they are evaluated.
#pragma once

#include "renderer/bxdf/microfacet.h"
#include "renderer/texture/texture.h"

namespace tessera {

// The roughness along u and v. If both are constants, their distribution is computed once.
struct RoughnessInput {
  FloatInput u, v;
  bool remap = true;  // alpha is the square root of the value, else the value itself
  bool is_constant = true;
  MicrofacetDistribution constant;

  // Sets is_constant and constant from the other members.
  void Prepare();
  bool IsIsotropic() const { return u.texture == v.texture && (u.texture >= 0 || u.constant == v.constant); }
  bool IsConstant() const { return is_constant; }
  MicrofacetDistribution Evaluate(const TextureTable& textures, const TextureContext& context) const {
    return is_constant ? constant : EvaluateTextures(textures, context);
  }

 private:
  MicrofacetDistribution FromValues(float value_u, float value_v) const;
  MicrofacetDistribution EvaluateTextures(const TextureTable& textures, const TextureContext& context) const;
};

// The index of refraction of an interface: below it over above it.
struct EtaInput {
  Spectrum spectrum = Spectrum::Constant(1.5f);
  bool disperses = false;
  float constant = 1.5f;

  static EtaInput From(const Spectrum& spectrum);
  // Evaluates at the first wavelength; drops the others if they would be refracted differently.
  float Evaluate(SampledWavelengths& wavelengths) const {
    if (!disperses) return constant;
    wavelengths.TerminateSecondary();
    return ValueAt(wavelengths.lambda[0]);
  }
  // lambda in nm. Returns 1 where the spectrum is not positive.
  float ValueAt(float lambda) const;
};

template <typename... Inputs>
bool AnyTexture(const Inputs&... inputs) {
  return (!inputs.IsConstant() || ...);
}

// Where a material is evaluated. Called with an input, gives its value there.
struct MaterialContext {
  const TextureTable& textures;
  const TextureContext& texture_context;
  SampledWavelengths& wavelengths;
  bool regularizes = false;  // whether surfaces are rougher than their parameters ask for

  float operator()(const FloatInput& input) const { return textures.Evaluate(input, texture_context); }
  SampledSpectrum operator()(const SpectrumInput& input) const {
    return textures.Evaluate(input, texture_context, wavelengths);
  }
  MicrofacetDistribution operator()(const RoughnessInput& input) const {
    const MicrofacetDistribution facets = input.Evaluate(textures, texture_context);
    return regularizes ? facets.Regularized() : facets;
  }
  float operator()(const EtaInput& input) const { return input.Evaluate(wavelengths); }
};

inline SampledSpectrum Clamp(SampledSpectrum v, float low, float high) {
  return Min(Max(v, SampledSpectrum(low)), SampledSpectrum(high));
}

}  // namespace tessera
