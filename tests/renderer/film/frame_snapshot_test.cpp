// A snapshot is a value: what the merger does later must not change it.
#include "renderer/film/frame_snapshot.h"

#include <gtest/gtest.h>

#include "renderer/film/merger.h"

namespace tessera {
namespace {

FrameSpec TwoTiles() {
  FrameSpec spec;
  spec.width = 4;
  spec.height = 2;
  spec.crop = {0, 0, 4, 2};
  spec.tile_size = 2;
  spec.samples_per_pixel = 4;
  spec.channels = ColorsAndWeight({"R"});
  return spec;
}

TileNode Node(uint32_t tile, SampleRange range, float value) {
  std::vector<float> sums;
  for (int pixel = 0; pixel < 4; ++pixel) {
    sums.push_back(value * static_cast<float>(range.size));
    sums.push_back(static_cast<float>(range.size));
  }
  return {tile, range, std::move(sums)};
}

TEST(FrameSnapshot, StaysAsItWasWhileTheMergerGoesOn) {
  Merger merger(TwoTiles());
  ASSERT_TRUE(merger.Add(Node(0, {0, 1}, 1)));
  const FrameSnapshot snapshot = merger.Snapshot();
  ASSERT_TRUE(merger.Add(Node(0, {1, 1}, 3)));
  ASSERT_TRUE(merger.Add(Node(1, {0, 4}, 5)));
  const FramePicture before = snapshot.Picture();
  EXPECT_EQ(before.values, (std::vector<float>{1, 1, 0, 0, 1, 1, 0, 0}));
  EXPECT_EQ(before.samples_min, 0u);
  EXPECT_EQ(merger.Picture().values, (std::vector<float>{2, 2, 5, 5, 2, 2, 5, 5}));
  EXPECT_EQ(merger.Picture().samples_min, 2u);
}

TEST(FrameSnapshot, SharesTheSumsWithTheNodesThatTheMergerGivesOut) {
  Merger merger(TwoTiles());
  ASSERT_TRUE(merger.Add(Node(1, {0, 4}, 5)));
  const std::vector<TileNode> first = merger.AllNodes();
  const std::vector<TileNode> second = merger.AllNodes();
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(&*first[0].sums, &*second[0].sums);
}

TEST(FrameSnapshot, TilesAreTheSameUntilTheirSumsChange) {
  Merger merger(TwoTiles());
  const FrameSnapshot nothing = merger.Snapshot();
  EXPECT_TRUE(FrameSnapshot().IsSameTile(1, nothing));
  ASSERT_TRUE(merger.Add(Node(0, {0, 1}, 1)));
  const FrameSnapshot before = merger.Snapshot();
  EXPECT_FALSE(before.IsSameTile(0, nothing));
  EXPECT_TRUE(before.IsSameTile(1, nothing));
  EXPECT_TRUE(before.IsSameTile(0, merger.Snapshot()));
  ASSERT_TRUE(merger.Add(Node(0, {1, 1}, 1)));
  EXPECT_FALSE(merger.Snapshot().IsSameTile(0, before));
}

TEST(FrameSnapshot, TilesTogetherShowWhatAReducedPictureShows) {
  FrameSpec spec = TwoTiles();
  spec.width = 7;
  spec.height = 5;
  spec.crop = {1, 1, 7, 5};
  spec.tile_size = 4;
  Merger merger(spec);
  for (uint32_t tile = 0; tile < static_cast<uint32_t>(spec.TileCount()); ++tile) {
    std::vector<float> sums;
    for (int i = 0; i < spec.TileBounds(static_cast<int>(tile)).area(); ++i) {
      sums.push_back(static_cast<float>(100 * tile + static_cast<uint32_t>(i)) * 4);
      sums.push_back(4);
    }
    ASSERT_TRUE(merger.Add({tile, {0, 4}, std::move(sums)}));
  }
  const FrameSnapshot snapshot = merger.Snapshot();
  const FramePicture whole = snapshot.Picture();
  for (const int step : {1, 2, 3, 5}) {
    int pixels = 0;
    for (int tile = 0; tile < spec.TileCount(); ++tile) {
      const FramePicture part = snapshot.TilePicture(tile, step);
      size_t i = 0;
      for (int y = part.bounds.y0; y < part.bounds.y1; ++y) {
        for (int x = part.bounds.x0; x < part.bounds.x1; ++x, ++pixels)
          EXPECT_EQ(part.values[i++], whole.values[static_cast<size_t>(y * step * 6 + x * step)]);
      }
    }
    EXPECT_EQ(pixels, ((6 + step - 1) / step) * ((4 + step - 1) / step));
  }
}

TEST(FrameSnapshot, OutlivesItsMerger) {
  FrameSnapshot snapshot;
  {
    Merger merger(TwoTiles());
    ASSERT_TRUE(merger.Add(Node(0, {0, 4}, 7)));
    snapshot = merger.Snapshot();
  }
  EXPECT_EQ(snapshot.Picture().values, (std::vector<float>{7, 7, 0, 0, 7, 7, 0, 0}));
}

TEST(FrameSnapshot, APreviewOfManyValuesHasEveryNthPixel) {
  Merger merger(TwoTiles());
  for (const uint32_t tile : {0u, 1u})
    ASSERT_TRUE(merger.Add(Node(tile, {0, 4}, 5 + static_cast<float>(tile))));
  const FrameSnapshot snapshot = merger.Snapshot();
  const auto whole = snapshot.MakePreview(8);
  EXPECT_EQ(whole.spec, TwoTiles());
  EXPECT_EQ(whole.picture.values, snapshot.Picture().values);
  const auto half = snapshot.MakePreview(7);
  EXPECT_EQ(half.spec.crop, (PixelBounds{0, 0, 2, 1}));
  EXPECT_EQ(half.picture.values, (std::vector<float>{5, 6}));
  EXPECT_TRUE(half.spec.Check());
  const auto least = snapshot.MakePreview(1);
  EXPECT_EQ(least.picture.values, (std::vector<float>{5}));
}

TEST(FrameSnapshot, WithoutTilesItIsBlack) {
  const FramePicture picture = FrameSnapshot(TwoTiles(), {}).Picture();
  EXPECT_EQ(picture.values, std::vector<float>(8, 0.0f));
  EXPECT_EQ(picture.samples_min, 0u);
}

}  // namespace
}  // namespace tessera
