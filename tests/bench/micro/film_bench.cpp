// The film: adding samples up, the codec of tiles, and merging.
#include <memory>

#include "renderer/film/merger.h"
#include "tests/bench/micro/micro_bench.h"
#include "tests/renderer/film/rule_frames.h"

namespace tessera {
namespace {

constexpr uint32_t kTileSamples = 16;

struct NamedFrame {
  std::string name;
  FrameSpec spec;
};

// A frame of colours alone, and one with channels of every type and rule. Of one tile.
std::vector<NamedFrame> Frames() {
  FrameSpec colors;
  colors.samples_per_pixel = kTileSamples;
  std::vector<NamedFrame> frames{{"colors", colors}, {"every_rule", RuleSpec(kTileSamples)}};
  for (NamedFrame& frame : frames) {
    frame.spec.width = frame.spec.height = frame.spec.tile_size = kTileSizeDefault;
    frame.spec.crop = {0, 0, kTileSizeDefault, kTileSizeDefault};
  }
  return frames;
}

// All records of the tile at the same numbers: what the time depends on is the layout.
RadianceTile AddUp(const ChannelLayout& layout, PixelBounds bounds, const NumberRing& numbers) {
  const PixelShape& shape = layout.shape();
  TileBuilder tile(layout, bounds, {0, kTileSamples});
  size_t next = 0;
  for (int64_t pixel = 0; pixel < bounds.area(); ++pixel) {
    for (uint32_t sample = 0; sample < kTileSamples; ++sample) {
      float* const values = tile.Values();
      for (size_t i = 0; i < shape.sums + shape.nearest; ++i) values[i] = numbers.At(next++) + 0.5f;
      for (size_t set = 0; set < shape.id_sets; ++set) tile.AddId(set, IdOf(sample % 3), 1);
      tile.AddSample();
    }
    tile.EndPixel();
  }
  return tile.Take();
}

void AddFrame(const NamedFrame& frame) {
  const ChannelLayout layout = frame.spec.Layout();
  const PixelBounds bounds = frame.spec.crop;
  const std::string suffix = "/tile_of_1024_pixels/" + frame.name;
  AddBenchmark("film/add_16_samples" + suffix, [layout, bounds, numbers = NumberRing(1)](size_t) {
    return AddUp(layout, bounds, numbers).sums.size();
  });
  const auto tile = std::make_shared<const RadianceTile>(AddUp(layout, bounds, NumberRing(1)));
  const auto bytes = std::make_shared<const std::string>(EncodeRadianceTile(*tile));
  AddBenchmark("film/encode" + suffix, [tile](size_t) { return EncodeRadianceTile(*tile).size(); });
  const TileRequest request{tile->bounds, tile->range, tile->shape};
  if (!DecodeRadianceTile(*bytes, request)) return AddFailure("film/decode" + suffix, "the tile is refused");
  AddBenchmark("film/decode" + suffix,
               [bytes, request](size_t) { return DecodeRadianceTile(*bytes, request)->sums.size(); });
  AddBenchmark("film/merge" + suffix, [tile, spec = frame.spec](size_t) {
    Merger merger(spec);
    return merger.Add(0, *tile).has_value();
  });
  AddBenchmark("film/picture" + suffix,
               [tile, spec = frame.spec, merger = std::shared_ptr<Merger>()](size_t) mutable {
                 if (merger == nullptr) {
                   merger = std::make_shared<Merger>(spec);
                   TESSERA_CHECK(merger->Add(0, *tile).has_value());
                 }
                 return merger->Picture().values.size();
               });
}

}  // namespace

void AddFilmBenchmarks() {
  for (const NamedFrame& frame : Frames()) AddFrame(frame);
}

}  // namespace tessera
