#include "renderer/material/coated_diffuse_material.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace tessera {
namespace {

int IntegerInRange(ParameterReader& parameters, const char* name, int default_value, int min, int max) {
  const int value = parameters.Integer(name, default_value);
  if (value < min || value > max) {
    parameters.FailAt(name, fmt::format("\"{}\" of a coat must be from {} to {}", name, min, max));
  }
  return value;
}

}  // namespace

CoatedDiffuseMaterial CoatedDiffuseMaterial::Read(MaterialReader& reader) {
  CoatedDiffuseMaterial material;
  material.reflectance = reader.Albedo("reflectance", 0.5f);
  material.albedo = reader.Albedo("albedo", 0);
  material.roughness = reader.Roughness();
  material.eta = reader.Eta();
  material.thickness = reader.Float("thickness", 0.01f);
  material.thickness.constant = std::max(material.thickness.constant, std::numeric_limits<float>::min());
  material.g = reader.Float("g", 0);
  material.depth_max = IntegerInRange(reader.parameters, "maxdepth", 10, 0, kLayerDepthMax);
  material.sample_count = IntegerInRange(reader.parameters, "nsamples", 1, 1, kLayerSamplesMax);
  if (!reader.parameters.failed()) material.Prepare(reader.coats);
  return material;
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

Bxdf CoatedDiffuseMaterial::MakeBxdf(const MaterialContext& at) const {
  const float eta_here = at(eta);
  const DielectricBxdf coat(at(roughness), eta_here);
  const SampledSpectrum reflectance_here = Clamp(at(reflectance), 0, 1);
  const float alpha = coat.facets().alpha_x();
  const bool in_table =
      table_kind != Table::kNone && (table_kind != Table::kAlpha || alpha <= CoatTable::kAlphaRowMax);
  if (in_table) {
    const float parameter = table_kind == Table::kAlpha ? alpha : eta_here;
    return CoatedDiffuseBxdf(coat, table->At(parameter), reflectance_here,
                             CoatedDiffuseBxdf::BaseHits(depth_max));
  }
  CoatLayer layer;
  layer.thickness = std::max(std::numeric_limits<float>::min(), at(thickness));
  layer.albedo = Clamp(at(albedo), 0, 1);
  layer.g = std::clamp(at(g), -1.0f, 1.0f);
  layer.depth_max = depth_max;
  layer.sample_count = sample_count;
  return LayeredDiffuseBxdf(coat, reflectance_here, layer);
}

}  // namespace tessera
