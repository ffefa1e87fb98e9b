// Which materials look at textures: the others need no footprint of the pixel.
#pragma once

#include "renderer/material/material_kinds.h"

namespace tessera {

// Whether any input of the material itself is a texture; of a mix, its amount alone.
bool ReadsTextures(const Material& material);

}  // namespace tessera
