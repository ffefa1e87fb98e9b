#include "tests/simulation/picture_model.h"

#include "renderer/film/adaptive.h"
#include "renderer/film/dyadic_sum.h"
#include "renderer/util/hash.h"

namespace tessera {

FrameSpec SmallFrame(int width, int height, int tile_size, uint32_t samples_per_pixel) {
  FrameSpec spec;
  spec.width = width;
  spec.height = height;
  spec.crop = {0, 0, width, height};
  spec.tile_size = tile_size;
  spec.samples_per_pixel = samples_per_pixel;
  spec.channels = ColorsAndWeight({"R"});
  return spec;
}

// Tiles and pixels differ in noise: in adaptive frames they stop at different counts of samples.
RadianceTile RenderModel(uint64_t seed, const FrameSpec& spec, uint32_t tile_index, const PixelMask& pixels,
                         SampleRange range) {
  const PixelBounds bounds = spec.TileBounds(static_cast<int>(tile_index));
  RadianceTile tile{bounds, range, spec.Layout().shape(), {}};
  for (int y = bounds.y0; y < bounds.y1; ++y) {
    for (int x = bounds.x0; x < bounds.x1; ++x) {
      DyadicSum<float> radiance, weight;
      for (uint32_t s = range.begin; s < range.end(); ++s) {
        const uint64_t place = Hash(seed, static_cast<uint64_t>(x), static_cast<uint64_t>(y), s);
        const float w = 0.5f + UniformFloat(static_cast<uint32_t>(place));
        const float spread = (0.4f + 0.15f * static_cast<float>(y % 8)) / static_cast<float>(1 + x / 8 * 2);
        radiance.Add(w * (0.5f + spread * (UniformFloat(static_cast<uint32_t>(place >> 32)) - 0.5f)));
        weight.Add(w);
      }
      tile.sums.push_back(radiance.Node());
      if (spec.IsAdaptive()) tile.sums.push_back(static_cast<float>(range.size));
      tile.sums.push_back(weight.Node());
    }
  }
  if (spec.IsAdaptive()) KeepPixels(pixels, tile);
  return tile;
}

Merger ReferenceMerger(uint64_t seed, const FrameSpec& spec) {
  Merger merger(spec);
  for (int tile = 0; tile < spec.TileCount(); ++tile) {
    for (auto missing = merger.Missing(tile); !missing.empty(); missing = merger.Missing(tile)) {
      const PixelMask pixels = merger.Goal(tile).pixels;
      for (const SampleRange range : missing) {
        RadianceTile sums = RenderModel(seed, spec, static_cast<uint32_t>(tile), pixels, range);
        TESSERA_CHECK(merger.Add(tile, std::move(sums)).has_value());
      }
    }
  }
  return merger;
}

}  // namespace tessera
