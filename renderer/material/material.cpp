#include "renderer/material/material.h"

#include <algorithm>

#include "renderer/util/dispatch.h"

namespace tessera {

Result<MaterialTable> MaterialTable::Build(const SceneDescription& scene, TextureBuilder& textures) {
  MaterialTable table;
  CoatTableCache coats;
  MeasuredBrdfCache measured;
  ProfileCache profiles(textures.files().cache());
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const Entity& entity = scene.materials[i].entity;
    const std::string name = entity.kind.empty() ? "interface" : entity.kind;
    const auto* kind = MaterialKinds().Find(name);
    if (kind == nullptr) return ErrorAt(entity.location, MaterialKinds().Refusal(name));
    ParameterReader parameters(entity);
    MaterialReader reader{parameters, textures, coats, measured, profiles, scene, static_cast<int>(i)};
    Material material = kind->reader(reader);
    if (const Result<void> finished = parameters.Finish(); !finished) return finished.error();
    table.materials_.push_back(std::move(material));
  }
  table.SetTraits();
  return table;
}

MaterialTable::Traits MaterialTable::TraitsOf(const Material& material) const {
  return Dispatch(
      material,
      Overloads{
          [](const SurfaceMaterial& surface) {
            const bool reads = Dispatch(surface.kind, [](const auto& kind) { return kind.ReadsTextures(); });
            const bool isotropic =
                Dispatch(surface.kind, [](const auto& kind) { return kind.IsIsotropic(); });
            return Traits{std::holds_alternative<InterfaceMaterial>(surface.kind),
                          reads || surface.relief.ReadsTextures(),
                          std::holds_alternative<SubsurfaceMaterial>(surface.kind), isotropic,
                          surface.relief.NeedsNormalDerivatives()};
          },
          // A mix needs what the materials it chooses from need.
          [&](const MixMaterial& mix) {
            const Traits& first = traits_[mix.first];
            const Traits& second = traits_[mix.second];
            return Traits{false, mix.ReadsTextures() || first.needs_footprint || second.needs_footprint,
                          first.scatters_below || second.scatters_below,
                          first.is_isotropic && second.is_isotropic,
                          first.needs_normal_derivatives || second.needs_normal_derivatives};
          },
      });
}

void MaterialTable::SetTraits() {
  // A mix without a name may choose from materials that come later in the table. Those count as needing it.
  traits_.assign(materials_.size(), {false, true, true, false, true});
  for (size_t i = 0; i < materials_.size(); ++i) traits_[i] = TraitsOf(materials_[i]);
}

const SurfaceMaterial& MaterialTable::Chosen(int material, const TextureTable& textures,
                                             const TextureContext& context,
                                             const SurfaceInteraction& interaction) const {
  for (;;) {
    if (const auto* surface = std::get_if<SurfaceMaterial>(&materials_[material])) return *surface;
    material = std::get<MixMaterial>(materials_[material]).Choose(textures, context, interaction);
  }
}

const Spectrum* MaterialTable::MatteReflectance(int material) const {
  const auto* surface = std::get_if<SurfaceMaterial>(&materials_[material]);
  if (surface == nullptr || traits_[material].needs_footprint) return nullptr;
  const auto* diffuse = std::get_if<DiffuseMaterial>(&surface->kind);
  return diffuse == nullptr ? nullptr : &diffuse->reflectance.constant;
}

bool MaterialTable::AnyScattersBelow() const {
  return std::ranges::any_of(traits_, [](const Traits& traits) { return traits.scatters_below; });
}

std::optional<Subsurface> MaterialTable::SubsurfaceAt(int material, const TextureTable& textures,
                                                      const TextureContext& context,
                                                      const SurfaceInteraction& interaction,
                                                      SampledWavelengths& wavelengths) const {
  const SurfaceMaterial& surface = Chosen(material, textures, context, interaction);
  const auto* subsurface = std::get_if<SubsurfaceMaterial>(&surface.kind);
  if (subsurface == nullptr) return std::nullopt;
  return subsurface->At({textures, context, wavelengths}, interaction.p, interaction.shading.n);
}

Bsdf MaterialTable::Evaluate(int material, const TextureTable& textures, const TextureContext& context,
                             SurfaceInteraction& interaction, SampledWavelengths& wavelengths,
                             bool regularizes) const {
  const SurfaceMaterial& surface = Chosen(material, textures, context, interaction);
  surface.relief.Apply(textures, context, interaction);
  const MaterialContext at{textures, context, wavelengths, regularizes};
  const SurfaceInteraction::Shading& shading = interaction.shading;
  return Bsdf(
      traits_[material].is_isotropic ? Frame::FromZ(shading.n) : Frame::FromXZ(shading.dpdu, shading.n),
      [&] { return Dispatch(surface.kind, [&](const auto& kind) { return kind.MakeBxdf(at); }); });
}

}  // namespace tessera
