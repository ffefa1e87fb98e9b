// The footprint of a pixel at a surface point, for texture filtering.
#pragma once

#include "renderer/camera/camera.h"
#include "renderer/shape/interaction.h"
#include "renderer/texture/texture.h"

namespace tessera {

// The position alone, for materials without textures.
inline TextureContext PlaceOf(const SurfaceInteraction& interaction) {
  TextureContext context;
  context.p = interaction.p;
  context.n = interaction.shading.n;
  context.uv = interaction.uv;
  return context;
}

// `scale` shrinks the footprint of pixels with many samples.
TextureContext MakeTextureContext(const SurfaceInteraction& interaction, const Camera& camera, float scale);

}  // namespace tessera
