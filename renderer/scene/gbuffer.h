// The channels of pbrt's film "gbuffer", by its names: layers in a table of their own, as --aov does not
// offer them.
#pragma once

#include <span>

#include "renderer/scene/layers.h"

namespace tessera {

std::span<const Kind<Layer>> GbufferLayers();
void AddGbufferLayers(std::vector<Channel>& channels);

}  // namespace tessera
