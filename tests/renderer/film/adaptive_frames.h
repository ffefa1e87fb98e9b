// Adaptive frames for tests: a stand-in for the renderer whose tiles differ in noise, and ways to cut it up.
#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "renderer/film/adaptive.h"
#include "renderer/film/dyadic_sum.h"
#include "renderer/film/merger.h"
#include "renderer/util/hash.h"

namespace tessera {

inline FrameSpec AdaptiveSpec(uint32_t samples, double threshold) {
  FrameSpec spec;
  spec.width = 24;
  spec.height = 16;
  spec.crop = {1, 0, 24, 15};
  spec.tile_size = 8;
  spec.samples_per_pixel = samples;
  spec.SetNoiseThreshold(threshold);
  AddChannel(spec.channels, SamplesChannel(true));
  return spec;
}

// Samples lie around 1, the farther the greater the tile's index, and the farther right in the tile.
inline RadianceTile RenderNoise(const FrameSpec& spec, int tile, SampleRange range,
                                const PixelMask& pixels = {}) {
  RadianceTile result{spec.TileBounds(tile), range, spec.Layout().shape(), {}};
  const size_t samples = spec.Layout().samples().value_or(3), weight = spec.Layout().weight();
  for (int y = result.bounds.y0; y < result.bounds.y1; ++y) {
    for (int x = result.bounds.x0; x < result.bounds.x1; ++x) {
      const float spread = 0.01f * static_cast<float>((1 << tile) * (1 + x - result.bounds.x0));
      for (size_t c = 0; c < result.shape.sums; ++c) {
        DyadicSum<float> sum;
        for (uint32_t s = range.begin; s < range.end(); ++s) {
          const uint64_t h = Hash(static_cast<uint64_t>(x), y, s, c);
          const float noise = UniformFloat(static_cast<uint32_t>(h)) * 2 - 1;
          sum.Add(c != samples && c != weight ? 1 + spread * noise : 1);
        }
        result.sums.push_back(sum.Node());
      }
    }
  }
  KeepPixels(pixels, result);
  return result;
}

// The pixels that samples `range` of a tile are wanted of, as the frame's finished picture tells.
inline PixelMask WantedPixels(const FrameSpec& spec, const FramePicture& finished, int tile,
                              SampleRange range) {
  const PixelBounds bounds = spec.TileBounds(tile);
  const std::vector<float> samples = finished.Channel(kSamplesChannel);
  std::vector<bool> wanted;
  for (int y = bounds.y0; y < bounds.y1; ++y) {
    for (int x = bounds.x0; x < bounds.x1; ++x) {
      const int place = (y - spec.crop.y0) * spec.crop.width() + (x - spec.crop.x0);
      wanted.push_back(samples[static_cast<size_t>(place)] >= static_cast<float>(range.end()));
    }
  }
  return PixelMask::Of(wanted);
}

struct TileUnit {
  int tile;
  SampleRange range;
};

// All units of the frame up to its last sample, cut at random, some also left whole, some twice; shuffled.
inline std::vector<TileUnit> RandomUnits(const FrameSpec& spec, std::mt19937& generator) {
  std::vector<TileUnit> open, cut;
  for (int tile = 0; tile < spec.TileCount(); ++tile) {
    for (SampleRange range : UnitPartition(spec, spec.samples_per_pixel)) open.push_back({tile, range});
  }
  while (!open.empty()) {
    const TileUnit unit = open.back();
    open.pop_back();
    const bool split = unit.range.size > 1 && generator() % 2 == 0;
    if (split) {
      open.push_back({unit.tile, unit.range.Left()});
      open.push_back({unit.tile, unit.range.Right()});
    }
    if (!split || generator() % 4 == 0) cut.push_back(unit);
    if (generator() % 5 == 0) cut.push_back(unit);
  }
  std::ranges::shuffle(cut, generator);
  return cut;
}

// Renders what the tile wants until it wants no more.
inline void RenderWhatIsWanted(Merger& merger, int tile) {
  for (auto missing = merger.Missing(tile); !missing.empty(); missing = merger.Missing(tile)) {
    for (SampleRange range : missing)
      TESSERA_CHECK(
          merger.Add(tile, RenderNoise(merger.spec(), tile, range, merger.Goal(tile).pixels)).has_value());
  }
}

inline Merger MergeWhatIsWanted(const FrameSpec& spec) {
  Merger merger(spec);
  for (int tile = 0; tile < spec.TileCount(); ++tile) RenderWhatIsWanted(merger, tile);
  return merger;
}

}  // namespace tessera
