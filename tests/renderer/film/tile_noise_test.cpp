// The noise that people are shown is the relMSE that the picture has, as far as halves can tell.
#include <gtest/gtest.h>

#include "tests/renderer/film/adaptive_frames.h"

namespace tessera {
namespace {

FrameSpec UniformSpec(uint32_t samples) {
  FrameSpec spec;
  spec.width = spec.height = 128;
  spec.crop = {0, 0, 128, 128};
  spec.tile_size = 64;
  spec.samples_per_pixel = samples;
  return spec;
}

// Samples are 1 + spread x uniform in [-1, 1).
RadianceTile RenderUniform(const FrameSpec& spec, int tile, SampleRange range, float spread) {
  RadianceTile result{spec.TileBounds(tile), range, spec.Layout().shape(), {}};
  const size_t weight = spec.Layout().weight();
  for (int64_t p = 0; p < result.bounds.area(); ++p) {
    for (size_t c = 0; c < result.shape.sums; ++c) {
      float sum = 0;
      for (uint32_t s = range.begin; s < range.end(); ++s) {
        const uint64_t h = Hash(static_cast<uint64_t>(tile), p, s, c);
        sum += c == weight ? 1 : 1 + spread * (UniformFloat(static_cast<uint32_t>(h)) * 2 - 1);
      }
      result.sums.push_back(sum);
    }
  }
  return result;
}

TEST(TileNoise, IsTheVarianceOfThePictureRelativeToItsSquare) {
  const FrameSpec spec = UniformSpec(64);
  Merger merger(spec);
  EXPECT_FALSE(merger.noise());
  for (const SampleRange range : {SampleRange{0, 16}, SampleRange{16, 16}, SampleRange{32, 32}}) {
    for (int tile = 0; tile < spec.TileCount(); ++tile)
      ASSERT_TRUE(merger.Add(tile, RenderUniform(spec, tile, range, 0.5f)));
    if (range.begin == 0) {
      EXPECT_FALSE(merger.noise()) << "one half tells nothing";
      continue;
    }
    ASSERT_TRUE(merger.noise());
    const double expected = 0.25 / 3 / range.end() / 1.01;  // variance of a sample / n / (1 + 0.01)
    EXPECT_NEAR(*merger.noise(), expected, 0.1 * expected) << range.end();
  }
}

TEST(TileNoise, IsNotKnownOfAPictureWhoseTilesCameWhole) {
  const FrameSpec spec = UniformSpec(16);
  Merger merger(spec);
  for (int tile = 0; tile < spec.TileCount(); ++tile)
    ASSERT_TRUE(merger.Add(tile, RenderUniform(spec, tile, {0, 16}, 0.5f)));
  EXPECT_FALSE(merger.noise());
}

TEST(TileNoise, IsTheSameForAnyOrderOfArrival) {
  const FrameSpec spec = UniformSpec(4);
  std::vector<double> noises;
  for (const bool is_reversed : {false, true}) {
    std::vector<SampleRange> ranges{{0, 2}, {2, 2}};
    if (is_reversed) std::ranges::reverse(ranges);
    Merger merger(spec);
    for (const SampleRange range : ranges) {
      for (int tile = 0; tile < spec.TileCount(); ++tile)
        ASSERT_TRUE(merger.Add(tile, RenderUniform(spec, tile, range, 0.5f)));
    }
    ASSERT_TRUE(merger.noise());
    noises.push_back(*merger.noise());
  }
  EXPECT_DOUBLE_EQ(noises[0], noises[1]);
}

// Pixels that stop keep what they had.
TEST(TileNoise, OfAnAdaptiveFrameCountsPixelsThatHaveStopped) {
  const FrameSpec spec = AdaptiveSpec(256, 0.05);
  Merger merger(spec);
  double all = 0;
  for (int tile = 0; tile < spec.TileCount(); ++tile) {
    for (auto missing = merger.Missing(tile); !missing.empty(); missing = merger.Missing(tile)) {
      for (const SampleRange range : missing)
        ASSERT_TRUE(merger.Add(tile, RenderNoise(spec, tile, range, merger.Goal(tile).pixels)));
    }
  }
  ASSERT_TRUE(merger.Complete());
  ASSERT_TRUE(merger.noise());
  const FramePicture picture = merger.Picture();
  const std::vector<float> samples = picture.Channel(kSamplesChannel);
  for (int tile = 0; tile < spec.TileCount(); ++tile) {
    const PixelBounds bounds = spec.TileBounds(tile);
    for (int y = bounds.y0; y < bounds.y1; ++y) {
      for (int x = bounds.x0; x < bounds.x1; ++x) {
        const double spread = 0.01 * (1 << tile) * (1 + x - bounds.x0);
        const int place = (y - spec.crop.y0) * spec.crop.width() + (x - spec.crop.x0);
        all += spread * spread / 3 / samples[static_cast<size_t>(place)] / 1.01;
      }
    }
  }
  const double expected = all / static_cast<double>(spec.crop.area());
  EXPECT_NEAR(*merger.noise(), expected, 0.5 * expected);
}

TEST(TileNoise, OfAFrameWithoutColoursIsNotKnown) {
  FrameSpec spec = UniformSpec(2);
  spec.channels = ColorsAndWeight({"S0"});
  Merger merger(spec);
  for (const SampleRange range : {SampleRange{0, 1}, SampleRange{1, 1}}) {
    for (int tile = 0; tile < spec.TileCount(); ++tile)
      ASSERT_TRUE(merger.Add(tile, RenderUniform(spec, tile, range, 0.5f)));
  }
  EXPECT_FALSE(merger.noise());
}

}  // namespace
}  // namespace tessera
