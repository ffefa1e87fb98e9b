#include "renderer/material/material_kinds.h"

#include <algorithm>

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

void CoatedDiffuseMaterial::Prepare(CoatTableCache& cache) {
  if (!albedo.IsConstant() || albedo.constant.MaxValue() > 0) return;
  if (!thickness.IsConstant() || !roughness.IsIsotropic()) return;
  const float alpha = roughness.constant.alpha_x();
  if (!eta.disperses) {
    table_kind = roughness.is_constant ? Table::kConstant : Table::kAlpha;
    table = roughness.is_constant ? cache.Constant(alpha, eta.constant, thickness.constant)
                                  : cache.OverAlpha(eta.constant, thickness.constant);
    return;
  }
  if (!roughness.is_constant) return;
  float eta_min = eta.ValueAt(kLambdaMin), eta_max = eta_min;
  for (int lambda = kLambdaMin; lambda <= kLambdaMax; ++lambda) {
    const float value = eta.ValueAt(static_cast<float>(lambda));
    eta_min = std::min(eta_min, value);
    eta_max = std::max(eta_max, value);
  }
  table_kind = Table::kEta;
  table = cache.OverEta(alpha, eta_min, eta_max, thickness.constant);
}

}  // namespace tessera
