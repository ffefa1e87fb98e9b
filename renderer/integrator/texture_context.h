// The footprint of a pixel at a surface point, for texture filtering.
#pragma once

#include "camera/camera.h"
#include "shape/interaction.h"
#include "texture/texture.h"

namespace tessera {

// The place alone, for materials that look at no texture.
inline TextureContext PlaceOf(const SurfaceInteraction& interaction) {
  TextureContext context;
  context.p = interaction.p;
  context.n = interaction.shading.n;
  context.uv = interaction.uv;
  return context;
}

// `scale` shrinks the footprint for pixels that take many samples.
TextureContext MakeTextureContext(const SurfaceInteraction& interaction, const Camera& camera, float scale);

}  // namespace tessera
