// Adaptive frames for tests: a stand-in for the renderer whose tiles differ in noise, and ways to cut it up.
#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "film/adaptive.h"
#include "film/dyadic_sum.h"
#include "film/merger.h"
#include "util/hash.h"

namespace tessera {

inline FrameSpec AdaptiveSpec(uint32_t samples, double threshold) {
  FrameSpec spec;
  spec.width = 24;
  spec.height = 16;
  spec.crop = {1, 0, 24, 15};
  spec.tile_size = 8;
  spec.samples_per_pixel = samples;
  spec.noise_threshold = threshold;
  spec.samples_aov = true;
  return spec;
}

// Samples lie around 1, the farther the greater the tile's index.
inline RadianceTile RenderNoise(const FrameSpec& spec, int tile, SampleRange range) {
  RadianceTile result{spec.TileBounds(tile), range, spec.channel_count(), {}};
  const float spread = 0.02f * static_cast<float>(1 << tile);
  for (int y = result.bounds.y0; y < result.bounds.y1; ++y) {
    for (int x = result.bounds.x0; x < result.bounds.x1; ++x) {
      for (int c = 0; c < result.channels; ++c) {
        DyadicSum<float> sum;
        for (uint32_t s = range.begin; s < range.end(); ++s) {
          const uint64_t h = Hash(static_cast<uint64_t>(x), y, s, c);
          const float noise = UniformFloat(static_cast<uint32_t>(h)) * 2 - 1;
          sum.Add(c + 1 == result.channels ? 1 : 1 + spread * noise);
        }
        result.sums.push_back(sum.Node());
      }
    }
  }
  return result;
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
      TESSERA_CHECK(merger.Add(tile, RenderNoise(merger.spec(), tile, range)).has_value());
  }
}

inline Merger MergeWhatIsWanted(const FrameSpec& spec) {
  Merger merger(spec);
  for (int tile = 0; tile < spec.TileCount(); ++tile) RenderWhatIsWanted(merger, tile);
  return merger;
}

}  // namespace tessera
