// The stream of a picture that refines: its bytes, and what readers get of it.
#include "coordinator/web/api/picture_board.h"

#include <gtest/gtest.h>
#include <half.h>

#include <cstring>

#include "renderer/film/merger.h"
#include "tests/coordinator/web/api/shown_picture.h"

namespace tessera {
namespace {

FrameSpec SomeFrame(ExrType type = ExrType::kHalf) {
  FrameSpec spec;
  spec.width = 150;
  spec.height = 100;
  spec.crop = {10, 5, 150, 100};
  spec.tile_size = 48;
  spec.samples_per_pixel = 4;
  spec.exr_type = type;
  return spec;
}

TileNode Tile(const FrameSpec& spec, int tile, float value) {
  std::vector<float> sums;
  for (int64_t i = 0; i < spec.TileBounds(tile).area(); ++i)
    sums.insert(sums.end(), {value, 2 * value, static_cast<float>(i) / 7, 1});
  return {static_cast<uint32_t>(tile), {0, 1}, std::move(sums)};
}

// The values of the picture as its file has them.
std::vector<float> Expected(const FrameSnapshot& snapshot) {
  std::vector<float> values = snapshot.Picture().values;
  if (snapshot.spec().exr_type == ExrType::kHalf) {
    for (float& value : values) value = half(value);
  }
  return values;
}

TEST(PictureBoard, AReaderSeesTheValuesOfTheFile) {
  for (const ExrType type : {ExrType::kHalf, ExrType::kFloat}) {
    const FrameSpec spec = SomeFrame(type);
    Merger merger(spec);
    PictureBoard board;
    ShownPicture reader;
    for (int tile = 0; tile < spec.TileCount(); ++tile) {
      ASSERT_TRUE(merger.Add(Tile(spec, tile, 0.1f + static_cast<float>(tile))));
      board.Show(merger.Snapshot());
      board.SetState(static_cast<uint64_t>(tile), 100, false);
      reader.Receive(board);
      EXPECT_EQ(reader.values, Expected(merger.Snapshot()));
      EXPECT_EQ(reader.samples_done, static_cast<uint64_t>(tile));
    }
    EXPECT_EQ(reader.shape.crop.x0, 10);
    EXPECT_EQ(reader.frames, 1);
  }
}

TEST(PictureBoard, OnlyWhatHasChangedIsSentAgain) {
  const FrameSpec spec = SomeFrame();
  Merger merger(spec);
  for (int tile = 0; tile < spec.TileCount(); ++tile) ASSERT_TRUE(merger.Add(Tile(spec, tile, 1)));
  PictureBoard board;
  board.Show(merger.Snapshot());
  ShownPicture reader;
  const size_t first = reader.Receive(board);
  EXPECT_EQ(reader.Receive(board), 0u);
  TileNode more = Tile(spec, 0, 3);
  more.range = {1, 1};
  ASSERT_TRUE(merger.Add(std::move(more)));
  board.Show(merger.Snapshot());
  const size_t second = reader.Receive(board);
  EXPECT_GT(second, 0u);
  EXPECT_LT(second, first / 2);
  EXPECT_EQ(reader.values, Expected(merger.Snapshot()));
}

TEST(PictureBoard, AReaderThatTakesLittleAtATimeGetsTheNewestOfEverything) {
  const FrameSpec spec = SomeFrame();
  Merger merger(spec);
  PictureBoard board;
  ShownPicture slow;
  for (int tile = 0; tile < spec.TileCount(); ++tile) {
    ASSERT_TRUE(merger.Add(Tile(spec, tile, static_cast<float>(tile))));
    board.Show(merger.Snapshot());
    slow.ReceiveOnce(board, 1);
  }
  while (slow.ReceiveOnce(board, 1) > 0) {
  }
  EXPECT_EQ(slow.values, Expected(merger.Snapshot()));
}

TEST(PictureBoard, ReadersShareTheEncodedRegions) {
  const FrameSpec spec = SomeFrame();
  Merger merger(spec);
  ASSERT_TRUE(merger.Add(Tile(spec, 0, 1)));
  PictureBoard board;
  board.Show(merger.Snapshot());
  PictureBoard::Cursor a, b;
  std::vector<BodyStream::Part> parts_a, parts_b;
  board.Collect(SIZE_MAX, a, parts_a);
  board.Collect(SIZE_MAX, b, parts_b);
  EXPECT_EQ(parts_a, parts_b) << "the same bytes, not copies";
}

TEST(PictureBoard, AFrameWithoutColoursOrWithHugeValuesIsShown) {
  FrameSpec spec = SomeFrame();
  spec.channels = ColorsAndWeight({"Y"});
  Merger merger(spec);
  std::vector<float> sums;
  for (int64_t i = 0; i < spec.TileBounds(0).area(); ++i) sums.insert(sums.end(), {1e9f, 1});
  ASSERT_TRUE(merger.Add({0, {0, 1}, std::move(sums)}));
  PictureBoard board;
  board.Show(merger.Snapshot());
  ShownPicture reader;
  reader.Receive(board);
  EXPECT_EQ(reader.values[0], 65504.0f);
  EXPECT_EQ(reader.values[2], 65504.0f);
}

TEST(PictureBoard, LargeFramesAreReduced) {
  FrameSpec spec = SomeFrame();
  spec.width = 16384;
  spec.height = 16384;
  spec.crop = {0, 0, 16384, 16384};
  const PictureLayer colors = LayersOf(spec).front();
  const PictureShape shape = ShapeOf(spec, colors, kLiveValuesMax);
  EXPECT_LE(int64_t{shape.width} * shape.height * 3, kLiveValuesMax);
  EXPECT_EQ(shape.step, 12);
  EXPECT_EQ(ShapeOf(SomeFrame(), colors, kLiveValuesMax).step, 1);
  EXPECT_EQ(ShapeOf(spec, colors, 0).width, 1) << "there is always a pixel";
}

TEST(PictureBoard, AnExtendedFrameBeginsAnewOnlyIfItsShapeDiffers) {
  FrameSpec spec = SomeFrame();
  Merger merger(spec);
  ASSERT_TRUE(merger.Add(Tile(spec, 0, 1)));
  PictureBoard board;
  board.Show(merger.Snapshot());
  ShownPicture reader;
  reader.Receive(board);
  spec.crop = {0, 0, 100, 100};
  board.Show(Merger(spec).Snapshot());
  reader.Receive(board);
  EXPECT_EQ(reader.frames, 2);
  EXPECT_EQ(reader.values, std::vector<float>(100 * 100 * 3, 0.0f));
}

}  // namespace
}  // namespace tessera
