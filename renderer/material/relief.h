// Bump and normal mapping: changes the shading frame of a point as if the surface had relief (Blinn 1978).
#pragma once

#include "renderer/material/normal_map.h"
#include "renderer/shape/interaction.h"
#include "renderer/texture/texture.h"

namespace tessera {

// Displaces the surface along its normal by a texture; finite differences over about a pixel, as pbrt-v4.
void ApplyBumpMap(const FloatInput& displacement, const TextureTable& textures, const TextureContext& context,
                  SurfaceInteraction& interaction);

// Turns the shading normal into that of the map.
void ApplyNormalMap(const NormalMap& map, SurfaceInteraction& interaction);

}  // namespace tessera
