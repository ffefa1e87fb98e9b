#include "renderer/film/tile_limit.h"

#include "renderer/film/frame_spec.h"

namespace tessera {

int LargestTileSize(const PixelShape& shape) {
  const auto pixel_bytes = static_cast<int64_t>(shape.floats_max() * sizeof(float));
  int size = kTileSizeMax;
  while (size > 1 && size * size * pixel_bytes > kTileBytesMax) --size;
  return size;
}

}  // namespace tessera
