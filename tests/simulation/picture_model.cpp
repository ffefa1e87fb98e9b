#include "tests/simulation/picture_model.h"

#include <optional>

#include "renderer/film/adaptive.h"
#include "renderer/film/tile_builder.h"
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

void AddModelLayers(FrameSpec& spec) {
  AddChannel(spec.channels, {"variance.R", ChannelType::kVariance});
  AddChannel(spec.channels, {"depth.Z", ChannelType::kDepth, MergeRule::kNearest});
  AddChannel(spec.channels, {"position.X", ChannelType::kFloat, MergeRule::kNearest});
  AddChannel(spec.channels, {"object", ChannelType::kIds, MergeRule::kIdWeights});
  AddChannel(spec.channels, {"hit.W", ChannelType::kHitWeight, MergeRule::kSum, false});
  AddChannel(spec.channels, {"u", ChannelType::kHitFloat});
}

namespace {

// Where a frame keeps the values of a sample.
struct ModelSlots {
  size_t red, weight;
  std::optional<size_t> variance, depth, position, hit_weight, u;

  explicit ModelSlots(const ChannelLayout& layout)
      : red(*layout.SlotOf("R")),
        weight(layout.weight()),
        variance(layout.SlotOf("variance.R")),
        depth(layout.SlotOf("depth.Z")),
        position(layout.SlotOf("position.X")),
        hit_weight(layout.SlotOf("hit.W")),
        u(layout.SlotOf("u")) {}
};

// Tiles and pixels differ in noise: in adaptive frames they stop at different counts of samples. One sample
// in eight hits nothing, and depths are few, so that there are ties.
void AddModelSample(uint64_t seed, int x, int y, uint32_t s, const ModelSlots& slots, TileBuilder& tile) {
  const uint64_t place = Hash(seed, static_cast<uint64_t>(x), static_cast<uint64_t>(y), s);
  const float w = 0.5f + UniformFloat(static_cast<uint32_t>(place));
  const float spread = (0.4f + 0.15f * static_cast<float>(y % 8)) / static_cast<float>(1 + x / 8 * 2);
  const float red = 0.5f + spread * (UniformFloat(static_cast<uint32_t>(place >> 32)) - 0.5f);
  float* const values = tile.Values();
  values[slots.red] = w * red;
  values[slots.weight] = w;
  if (slots.variance) {
    const auto depth = static_cast<float>(place >> 20 & 7);
    values[*slots.variance] = w * w * red * red;
    values[*slots.depth] = depth;
    if (depth > 0) {
      values[*slots.position] = static_cast<float>(s + 1);
      values[*slots.hit_weight] = w;
      values[*slots.u] = w * static_cast<float>(s);
      tile.AddId(0, static_cast<float>(1 + (place >> 24 & 3)), w);
    }
  }
  tile.AddSample();
}

}  // namespace

RadianceTile RenderModel(uint64_t seed, const FrameSpec& spec, uint32_t tile_index, const PixelMask& pixels,
                         SampleRange range) {
  const PixelBounds bounds = spec.TileBounds(static_cast<int>(tile_index));
  const ChannelLayout layout = spec.Layout();
  const ModelSlots slots(layout);
  TileBuilder tile(layout, bounds, range);
  size_t pixel = 0;
  for (int y = bounds.y0; y < bounds.y1; ++y) {
    for (int x = bounds.x0; x < bounds.x1; ++x, ++pixel) {
      if (spec.IsAdaptive() && !pixels.Has(pixel)) {
        tile.SkipPixel();
        continue;
      }
      for (uint32_t s = range.begin; s < range.end(); ++s) AddModelSample(seed, x, y, s, slots, tile);
      tile.EndPixel();
    }
  }
  return tile.Take();
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

JobOrder OrderOf(const JobSpec& spec) {
  JobOrder order{spec.submission, spec.name, spec.priority, {}};
  order.scene.package = spec.package;
  order.scene.scene_file = "scene#.pbrt";
  order.scene.frames = FrameRange{spec.frames.front().number, spec.frames.back().number, 1};
  return order;
}

}  // namespace tessera
