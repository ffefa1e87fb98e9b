#include "renderer/material/material_inputs.h"

namespace tessera {

void RoughnessInput::Prepare() {
  is_constant = u.IsConstant() && v.IsConstant();
  if (is_constant) constant = FromValues(u.constant, v.constant);
}

MicrofacetDistribution RoughnessInput::FromValues(float value_u, float value_v) const {
  if (!remap) return {value_u, value_v};
  return {MicrofacetDistribution::AlphaFromRoughness(value_u),
          MicrofacetDistribution::AlphaFromRoughness(value_v)};
}

MicrofacetDistribution RoughnessInput::EvaluateTextures(const TextureTable& textures,
                                                        const TextureContext& context) const {
  const float value_u = textures.Evaluate(u, context);
  if (IsIsotropic()) return FromValues(value_u, value_u);
  return FromValues(value_u, textures.Evaluate(v, context));
}

EtaInput EtaInput::From(const Spectrum& spectrum) {
  EtaInput eta;
  eta.spectrum = spectrum;
  eta.disperses = !spectrum.IsConstant();
  if (!eta.disperses) eta.constant = eta.ValueAt(kLambdaMin);
  return eta;
}

float EtaInput::ValueAt(float lambda) const {
  const float value = spectrum.At(lambda);
  return value > 0 ? value : 1;
}

}  // namespace tessera
