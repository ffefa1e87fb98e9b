#include "renderer/material/coated_diffuse_material.h"

#include <algorithm>

namespace tessera {

CoatedDiffuseMaterial CoatedDiffuseMaterial::Read(MaterialReader& reader) {
  CoatedDiffuseMaterial material;
  material.reflectance = reader.Albedo("reflectance", 0.5f);
  material.roughness = reader.Roughness();
  material.eta = reader.Eta();
  material.layer = CoatLayerInput::Read(reader);
  if (!reader.parameters.failed()) material.Prepare(reader.coats);
  return material;
}

void CoatedDiffuseMaterial::Prepare(CoatTableCache& cache) {
  const FloatInput& thickness = layer.thickness;
  if (!layer.IsClear() || !thickness.IsConstant() || !roughness.IsIsotropic()) return;
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

Bxdf CoatedDiffuseMaterial::MakeBxdf(const MaterialContext& at) const {
  const float eta_here = at(eta);
  const DielectricBxdf coat(at(roughness), eta_here);
  const SampledSpectrum reflectance_here = Clamp(at(reflectance), 0, 1);
  const float alpha = coat.facets().alpha_x();
  // The other tables are of the alpha that the material asks for.
  const bool has_alpha = table_kind == Table::kAlpha
                             ? alpha <= CoatTable::kAlphaRowMax
                             : !at.regularizes || alpha == roughness.constant.alpha_x();
  const bool in_table = table_kind != Table::kNone && has_alpha;
  if (in_table) {
    const float parameter = table_kind == Table::kAlpha ? alpha : eta_here;
    return CoatedDiffuseBxdf(coat, table->At(parameter), reflectance_here,
                             CoatedDiffuseBxdf::BaseHits(layer.depth_max));
  }
  return LayeredDiffuseBxdf(coat, reflectance_here, layer.Evaluate(at));
}

}  // namespace tessera
