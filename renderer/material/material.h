// Materials: what a surface is made of, from textures to a Bsdf at one point.
#pragma once

#include <optional>
#include <vector>

#include "renderer/bxdf/bsdf.h"
#include "renderer/color/wavelengths.h"
#include "renderer/description/scene_description.h"
#include "renderer/material/material_kinds.h"
#include "renderer/shape/interaction.h"
#include "renderer/texture/texture_builder.h"

namespace tessera {

// All materials of a scene, by the index of SceneDescription::materials. Immutable.
class MaterialTable {
 public:
  // Builds every material of the scene. Errors have their place; kinds that are not supported are refused by
  // name.
  static Result<MaterialTable> Build(const SceneDescription& scene, TextureBuilder& textures);

  // Whether the material is `interface`: rays pass, only the medium changes.
  bool IsInterface(int material) const { return traits_[material].is_interface; }

  // Whether Evaluate looks up textures, so that `context` must hold the footprint.
  bool NeedsFootprint(int material) const { return traits_[material].needs_footprint; }

  // Whether Evaluate, or the texture footprint that it needs, uses dpdu and dpdv of the interaction. A relief
  // reads a texture.
  bool NeedsTangents(int material) const {
    return traits_[material].needs_footprint || !traits_[material].is_isotropic;
  }

  // Whether Evaluate uses the derivatives of the interaction's normal.
  bool NeedsNormalDerivatives(int material) const { return traits_[material].needs_normal_derivatives; }

  // The reflectance of a diffuse material that is the same everywhere and has no relief; null of others.
  const Spectrum* MatteReflectance(int material) const;

  // The Bsdf of `material` at a surface point. Chooses among mixed materials by a hash of the point, changes
  // `interaction.shading` by bump or normal maps, and drops secondary wavelengths where the material
  // disperses. `context` holds the texture footprint if NeedsFootprint.
  // `regularizes`: MaterialContext.
  Bsdf Evaluate(int material, const TextureTable& textures, const TextureContext& context,
                SurfaceInteraction& interaction, SampledWavelengths& wavelengths,
                bool regularizes = false) const;

  // Whether light that enters the surface may come out elsewhere. Also true of a mix that may choose such a
  // material.
  bool ScattersBelow(int material) const { return traits_[material].scatters_below; }
  bool AnyScattersBelow() const;
  // Where such light comes out, for an interaction that Evaluate has seen. Returns nullopt if a mix chose
  // another material.
  std::optional<Subsurface> SubsurfaceAt(int material, const TextureTable& textures,
                                         const TextureContext& context, const SurfaceInteraction& interaction,
                                         SampledWavelengths& wavelengths) const;

  size_t size() const { return materials_.size(); }

 private:
  struct Traits {
    bool is_interface;
    bool needs_footprint;
    bool scatters_below;
    bool is_isotropic;  // what it scatters depends on azimuths only through their difference
    bool needs_normal_derivatives;
  };
  Traits TraitsOf(const Material& material) const;
  void SetTraits();
  // The material itself, or the one that a mix chooses here.
  const SurfaceMaterial& Chosen(int material, const TextureTable& textures, const TextureContext& context,
                                const SurfaceInteraction& interaction) const;

  std::vector<Material> materials_;
  std::vector<Traits> traits_;  // by material
};

}  // namespace tessera
