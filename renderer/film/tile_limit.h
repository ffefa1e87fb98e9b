// How large the tiles of a frame may be: the values of one must fit into a message to a coordinator.
#pragma once

#include <cstdint>

#include "renderer/film/channel_layout.h"

namespace tessera {

constexpr int64_t kTileBytesMax = int64_t{16} << 20;

// Pixels on a side of the largest tile whose pixels have this shape, at most kTileSizeMax.
int LargestTileSize(const PixelShape& shape);

}  // namespace tessera
