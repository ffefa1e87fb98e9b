#include "renderer/material/material.h"

#include "renderer/util/dispatch.h"

namespace tessera {

Result<MaterialTable> MaterialTable::Build(const SceneDescription& scene, TextureBuilder& textures) {
  MaterialTable table;
  CoatTableCache coats;
  MeasuredBrdfCache measured;
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const Entity& entity = scene.materials[i].entity;
    const std::string name = entity.kind.empty() ? "interface" : entity.kind;
    const auto* kind = MaterialKinds().Find(name);
    if (kind == nullptr) return ErrorAt(entity.location, MaterialKinds().Refusal(name));
    ParameterReader parameters(entity);
    MaterialReader reader{parameters, textures, coats, measured, scene, static_cast<int>(i)};
    Material material = kind->reader(reader);
    if (const Result<void> finished = parameters.Finish(); !finished) return finished.error();
    table.materials_.push_back(std::move(material));
  }
  table.SetTraits();
  return table;
}

MaterialTable::Traits MaterialTable::TraitsOf(const Material& material) const {
  return Dispatch(material,
                  Overloads{
                      [](const SurfaceMaterial& surface) {
                        const bool reads =
                            Dispatch(surface.kind, [](const auto& kind) { return kind.ReadsTextures(); });
                        return Traits{std::holds_alternative<InterfaceMaterial>(surface.kind),
                                      reads || surface.relief.ReadsTextures()};
                      },
                      // A mix needs what the materials it chooses from need.
                      [&](const MixMaterial& mix) {
                        return Traits{false, mix.ReadsTextures() || traits_[mix.first].needs_footprint ||
                                                 traits_[mix.second].needs_footprint};
                      },
                  });
}

void MaterialTable::SetTraits() {
  // A mix without a name may choose from materials that come later in the table. Those count as needing it.
  traits_.assign(materials_.size(), {false, true});
  for (size_t i = 0; i < materials_.size(); ++i) traits_[i] = TraitsOf(materials_[i]);
}

Bsdf MaterialTable::Evaluate(int material, const TextureTable& textures, const TextureContext& context,
                             SurfaceInteraction& interaction, SampledWavelengths& wavelengths) const {
  const SurfaceMaterial* surface = nullptr;
  while (surface == nullptr) {
    Dispatch(materials_[material],
             Overloads{
                 [&](const SurfaceMaterial& chosen) { surface = &chosen; },
                 [&](const MixMaterial& mix) { material = mix.Choose(textures, context, interaction); },
             });
  }
  surface->relief.Apply(textures, context, interaction);
  const MaterialContext at{textures, context, wavelengths};
  const Bxdf bxdf = Dispatch(surface->kind, [&](const auto& kind) { return kind.MakeBxdf(at); });
  return Bsdf(interaction.shading.n, interaction.shading.dpdu, bxdf);
}

}  // namespace tessera
