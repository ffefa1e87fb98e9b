// Materials: what a surface is made of, from textures to a Bsdf at one point.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "renderer/color/wavelengths.h"
#include "renderer/description/file_source.h"
#include "renderer/description/scene_description.h"
#include "renderer/material/bsdf.h"
#include "renderer/shape/interaction.h"
#include "renderer/texture/texture_builder.h"

namespace tessera {

struct Material;  // material_kinds.h

// All materials of a scene, by the index of SceneDescription::materials. Immutable.
class MaterialTable {
 public:
  MaterialTable();
  ~MaterialTable();
  MaterialTable(MaterialTable&&) noexcept;
  MaterialTable& operator=(MaterialTable&&) noexcept;

  // Builds every material of the scene. Errors carry their place; kinds that are not supported are named.
  static Result<MaterialTable> Build(const SceneDescription& scene, TextureBuilder& textures);

  // Whether the material is `interface`: rays pass, only the medium changes.
  bool IsInterface(int material) const;

  // Whether Evaluate looks at textures, so that `context` must hold the footprint.
  bool NeedsFootprint(int material) const { return needs_footprint_[material] != 0; }

  // The Bsdf of `material` at a surface point. Chooses among mixed materials by a hash of the place, changes
  // `interaction.shading` by bump or normal maps, and drops secondary wavelengths where the material
  // disperses. `context` holds the texture footprint, if that is needed.
  Bsdf Evaluate(int material, const TextureTable& textures, const TextureContext& context,
                SurfaceInteraction& interaction, SampledWavelengths& wavelengths) const;

  size_t size() const;

 private:
  void MarkNeeds();
  std::vector<Material> materials_;
  std::vector<uint8_t> needs_footprint_;  // by material
};

}  // namespace tessera
