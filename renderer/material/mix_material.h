// Chooses one of two other materials at each point of a surface.
#pragma once

#include <cstdint>

#include "renderer/material/material_reader.h"
#include "renderer/shape/interaction.h"

namespace tessera {

// Parameters: string materials (two names), float texture amount (0.5).
struct MixMaterial {
  int first = 0, second = 0;  // indices of materials, both smaller than that of a named mix
  FloatInput amount;          // the probability of `second`
  uint64_t names_hash = 0;    // of the names of both

  static MixMaterial Read(MaterialReader& reader);
  bool ReadsTextures() const { return AnyTexture(amount); }
  // `first` or `second`: the same for the same point and direction in every process.
  int Choose(const TextureTable& textures, const TextureContext& context,
             const SurfaceInteraction& interaction) const;
};

}  // namespace tessera
