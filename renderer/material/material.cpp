#include "renderer/material/material.h"

#include <bit>
#include <limits>

#include "renderer/material/material_builder.h"
#include "renderer/material/material_kinds.h"
#include "renderer/material/relief.h"
#include "renderer/material/texture_use.h"
#include "renderer/util/hash.h"

namespace tessera {
namespace {

// Where a material is evaluated.
struct MaterialContext {
  const TextureTable& textures;
  const TextureContext& texture_context;
  SampledWavelengths& wavelengths;

  float operator()(const FloatInput& input) const { return textures.Evaluate(input, texture_context); }
  SampledSpectrum operator()(const SpectrumInput& input) const {
    return textures.Evaluate(input, texture_context, wavelengths);
  }
  MicrofacetDistribution operator()(const RoughnessInput& input) const {
    return input.Evaluate(textures, texture_context);
  }
};

SampledSpectrum Clamp(SampledSpectrum v, float low, float high) {
  return Min(Max(v, SampledSpectrum(low)), SampledSpectrum(high));
}

Bxdf MakeBxdf(const DiffuseMaterial& m, const MaterialContext& at) {
  return DiffuseBxdf(Clamp(at(m.reflectance), 0, 1));
}

Bxdf MakeBxdf(const DiffuseTransmissionMaterial& m, const MaterialContext& at) {
  return DiffuseTransmissionBxdf(Clamp(at(m.reflectance) * m.scale, 0, 1),
                                 Clamp(at(m.transmittance) * m.scale, 0, 1));
}

Bxdf MakeBxdf(const ConductorMaterial& m, const MaterialContext& at) {
  const MicrofacetDistribution facets = at(m.roughness);
  if (!m.has_reflectance) return ConductorBxdf(facets, at(m.eta), at(m.k));
  // The k that reflects this much at normal incidence where eta is 1.
  const SampledSpectrum r = Clamp(at(m.eta), 0, 0.9999f);
  return ConductorBxdf(facets, SampledSpectrum(1.0f), 2.0f * Sqrt(r) / SafeSqrt(1.0f - r));
}

Bxdf MakeBxdf(const DielectricMaterial& m, const MaterialContext& at) {
  return DielectricBxdf(at(m.roughness), m.eta.Evaluate(at.wavelengths));
}

Bxdf MakeBxdf(const ThinDielectricMaterial& m, const MaterialContext& at) {
  return ThinDielectricBxdf(m.eta.Evaluate(at.wavelengths));
}

Bxdf MakeBxdf(const CoatedDiffuseMaterial& m, const MaterialContext& at) {
  using Table = CoatedDiffuseMaterial::Table;
  const float eta = m.eta.Evaluate(at.wavelengths);
  const DielectricBxdf coat(at(m.roughness), eta);
  const SampledSpectrum reflectance = Clamp(at(m.reflectance), 0, 1);
  const float alpha = coat.facets().alpha_x();
  const bool in_table =
      m.table_kind != Table::kNone && (m.table_kind != Table::kAlpha || alpha <= CoatTable::kAlphaRowMax);
  if (in_table) {
    const float parameter = m.table_kind == Table::kAlpha ? alpha : eta;
    return CoatedDiffuseBxdf(coat, m.table->At(parameter), reflectance,
                             CoatedDiffuseBxdf::BaseHits(m.depth_max));
  }
  CoatLayer layer;
  layer.thickness = std::max(std::numeric_limits<float>::min(), at(m.thickness));
  layer.albedo = Clamp(at(m.albedo), 0, 1);
  layer.g = std::clamp(at(m.g), -1.0f, 1.0f);
  layer.depth_max = m.depth_max;
  layer.sample_count = m.sample_count;
  return LayeredDiffuseBxdf(coat, reflectance, layer);
}

Bxdf MakeBxdf(const Material& material, const MaterialContext& at) {
  switch (material.kind.index()) {
    case 1: return MakeBxdf(*std::get_if<1>(&material.kind), at);
    case 2: return MakeBxdf(*std::get_if<2>(&material.kind), at);
    case 3: return MakeBxdf(*std::get_if<3>(&material.kind), at);
    case 4: return MakeBxdf(*std::get_if<4>(&material.kind), at);
    case 5: return MakeBxdf(*std::get_if<5>(&material.kind), at);
    case 6: return MakeBxdf(*std::get_if<6>(&material.kind), at);
    default: return Bxdf();  // an interface; a mix never comes here
  }
}

// In [0, 1), from the place, the direction and the names of the materials: the same in every process.
float MixSample(const MixMaterial& mix, const SurfaceInteraction& interaction) {
  const auto pair = [](float a, float b) {
    return uint64_t{std::bit_cast<uint32_t>(a)} << 32 | std::bit_cast<uint32_t>(b);
  };
  const Vec3 p = interaction.p, wo = interaction.wo;
  const uint64_t hash = Hash(mix.names_hash, pair(p.x, p.y), pair(p.z, wo.x), pair(wo.y, wo.z));
  return UniformFloat(static_cast<uint32_t>(hash >> 32));
}

int ChooseFrom(const MixMaterial& mix, const TextureTable& textures, const TextureContext& context,
               const SurfaceInteraction& interaction) {
  const float amount = textures.Evaluate(mix.amount, context);
  if (amount <= 0) return mix.first;
  if (amount >= 1) return mix.second;
  return amount < MixSample(mix, interaction) ? mix.first : mix.second;
}

}  // namespace

MaterialTable::MaterialTable() = default;
MaterialTable::~MaterialTable() = default;
MaterialTable::MaterialTable(MaterialTable&&) noexcept = default;
MaterialTable& MaterialTable::operator=(MaterialTable&&) noexcept = default;

Result<MaterialTable> MaterialTable::Build(const SceneDescription& scene, TextureBuilder& textures) {
  MaterialTable table;
  MaterialBuilder builder(scene, textures);
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    Result<Material> material = builder.Build(static_cast<int>(i));
    if (!material) return material.error();
    table.materials_.push_back(*std::move(material));
  }
  table.MarkNeeds();
  return table;
}

// A mix needs what those it chooses from need. One that is built later is taken to need it.
void MaterialTable::MarkNeeds() {
  needs_footprint_.assign(materials_.size(), 1);
  const auto needs = [&](const Material& material) {
    const MixMaterial* mix = std::get_if<MixMaterial>(&material.kind);
    const bool chosen = mix != nullptr && (needs_footprint_[mix->first] || needs_footprint_[mix->second]);
    return chosen || ReadsTextures(material);
  };
  for (size_t i = 0; i < materials_.size(); ++i) needs_footprint_[i] = needs(materials_[i]);
}

bool MaterialTable::IsInterface(int material) const {
  return std::holds_alternative<InterfaceMaterial>(materials_[material].kind);
}

Bsdf MaterialTable::Evaluate(int material, const TextureTable& textures, const TextureContext& context,
                             SurfaceInteraction& interaction, SampledWavelengths& wavelengths) const {
  const Material* chosen = &materials_[material];
  while (const MixMaterial* mix = std::get_if<MixMaterial>(&chosen->kind)) {
    chosen = &materials_[ChooseFrom(*mix, textures, context, interaction)];
  }
  if (chosen->normal_map) {
    ApplyNormalMap(*chosen->normal_map, interaction);
  } else if (chosen->displacement) {
    ApplyBumpMap(*chosen->displacement, textures, context, interaction);
  }
  const Bxdf bxdf = MakeBxdf(*chosen, {textures, context, wavelengths});
  return Bsdf(interaction.shading.n, interaction.shading.dpdu, bxdf);
}

size_t MaterialTable::size() const {
  return materials_.size();
}

}  // namespace tessera
