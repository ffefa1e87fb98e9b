// A frame with a channel of every rule and type, and a stand-in for the renderer that fills them.
#pragma once

#include <bit>
#include <vector>

#include "renderer/film/frame_spec.h"
#include "renderer/film/tile_builder.h"
#include "renderer/util/hash.h"

namespace tessera {

inline FrameSpec RuleSpec(uint32_t samples, double threshold = 0) {
  FrameSpec spec;
  spec.width = 9;
  spec.height = 7;
  spec.crop = {1, 2, 9, 7};
  spec.tile_size = 4;
  spec.samples_per_pixel = samples;
  AddChannel(spec.channels, {"object", ChannelType::kIds, MergeRule::kIdWeights});
  AddChannel(spec.channels, {"near.R", ChannelType::kColor, MergeRule::kNearest});
  AddChannel(spec.channels, {"albedo.R", ChannelType::kColor, MergeRule::kSum});
  AddChannel(spec.channels, {"Z", ChannelType::kDepth, MergeRule::kNearest});
  AddChannel(spec.channels, {"material", ChannelType::kIds, MergeRule::kIdWeights});
  AddChannel(spec.channels, {"normal.x", ChannelType::kFloat, MergeRule::kSum});
  AddChannel(spec.channels, SamplesChannel(true));
  spec.SetNoiseThreshold(threshold);
  return spec;
}

// The `index`-th of a pixel's ids.
inline float IdOf(uint32_t index) {
  return std::bit_cast<float>(0x3f000000u + index * 0x1234567u % 0x40000000u);
}

// What one sample of a pixel holds. Depths are few, so that there are ties; one in eight hits nothing.
struct RuleSample {
  float weight, red, albedo, normal;
  float depth;     // 0: nothing was hit
  float near_red;  // differs from sample to sample
  uint32_t object, material;
};

inline RuleSample SampleOf(int x, int y, uint32_t sample, uint32_t objects) {
  const uint64_t h = Hash(static_cast<uint64_t>(x), y, sample);
  const auto part = [&](int shift) { return UniformFloat(static_cast<uint32_t>(h >> shift) * 0x9e3779b9u); };
  const uint32_t depth = static_cast<uint32_t>(h >> 40) % 8;
  return {part(0) - 0.1f,
          part(8) * 4,
          part(16),
          part(24) * 2 - 1,
          static_cast<float>(depth),
          static_cast<float>(sample + 1),
          static_cast<uint32_t>(h >> 44) % objects,
          static_cast<uint32_t>(h >> 52) % 3};
}

inline RadianceTile RenderRules(const FrameSpec& spec, int tile, SampleRange range,
                                const PixelMask& pixels = {}, uint32_t objects = 5) {
  const ChannelLayout layout = spec.Layout();
  const PixelBounds bounds = spec.TileBounds(tile);
  TileBuilder builder(layout, bounds, range);
  const size_t object = layout.SlotOf("object").value() < layout.SlotOf("material").value() ? 0 : 1;
  size_t pixel = 0;
  for (int y = bounds.y0; y < bounds.y1; ++y) {
    for (int x = bounds.x0; x < bounds.x1; ++x, ++pixel) {
      if (!pixels.Has(pixel)) {
        builder.SkipPixel();
        continue;
      }
      for (uint32_t s = range.begin; s < range.end(); ++s) {
        const RuleSample sample = SampleOf(x, y, s, objects);
        float* values = builder.Values();
        for (const char* name : {"R", "G", "B"}) values[*layout.SlotOf(name)] = sample.red * sample.weight;
        values[layout.weight()] = sample.weight;
        values[*layout.SlotOf("albedo.R")] = sample.albedo * sample.weight;
        values[*layout.SlotOf("normal.x")] = sample.normal * sample.weight;
        if (sample.depth > 0) {
          values[*layout.SlotOf("Z")] = sample.depth;
          values[*layout.SlotOf("near.R")] = sample.near_red;
          builder.AddId(object, IdOf(sample.object), sample.weight);
          builder.AddId(1 - object, IdOf(sample.material), sample.weight);
        }
        builder.AddSample();
      }
      builder.EndPixel();
    }
  }
  return builder.Take();
}

}  // namespace tessera
