// Layers of a picture in its stream: which there are, and that readers see the values of the file.
#include "coordinator/web/api/picture_layers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "renderer/film/merger.h"
#include "tests/coordinator/web/api/shown_picture.h"

namespace tessera {
namespace {

FrameSpec Layered() {
  FrameSpec spec;
  spec.width = 100;
  spec.height = 70;
  spec.crop = {4, 2, 100, 70};
  spec.tile_size = 32;
  spec.samples_per_pixel = 4;
  for (const char* name : {"albedo.R", "albedo.G", "albedo.B", "light_key.R", "light_key.G", "light_key.B",
                           "light_sky.R", "light_sky.G", "light_sky.B"})
    AddChannel(spec.channels, {name, ChannelType::kColor, MergeRule::kSum, true});
  AddChannel(spec.channels, {"heat", ChannelType::kFloat, MergeRule::kSum, true});
  return spec;
}

TileNode Node(const FrameSpec& spec, int tile, SampleRange range, float value) {
  const size_t stride = spec.Layout().shape().stride();
  std::vector<float> sums(static_cast<size_t>(spec.TileBounds(tile).area()) * stride);
  for (size_t i = 0; i < sums.size(); ++i) {
    sums[i] = i % stride == spec.Layout().weight()
                  ? static_cast<float>(range.size)
                  : static_cast<float>(range.size) * (value + static_cast<float>(i % stride));
  }
  return {static_cast<uint32_t>(tile), range, std::move(sums)};
}

std::vector<std::string> NamesOf(const FrameSpec& spec) {
  std::vector<std::string> names;
  for (const PictureLayer& layer : LayersOf(spec)) names.push_back(layer.name);
  return names;
}

TEST(PictureLayers, AreThoseOfTheFileWithColoursFirstAndProgressLast) {
  EXPECT_THAT(NamesOf(Layered()), testing::ElementsAre("", "albedo", "light_key", "light_sky", "heat",
                                                       kLightsLayer, kSamplesLayer, kNoiseLayer));
  EXPECT_THAT(NamesOf(FrameSpec{}), testing::ElementsAre("", kSamplesLayer, kNoiseLayer));
  EXPECT_EQ(FindLayer(Layered(), kLightsLayer)->channels.size(), 6u);
  EXPECT_TRUE(FindLayer(Layered(), "heat")->is_exact);
  EXPECT_FALSE(FindLayer(Layered(), "albed"));
  EXPECT_FALSE(FindLayer(FrameSpec{}, kLightsLayer));
}

TEST(PictureLayers, LeaveOutEveryRankOfMattes) {
  FrameSpec spec;
  AddChannel(spec.channels, {"CryptoObject", ChannelType::kIds, MergeRule::kIdWeights});
  for (const uint32_t levels : {1u, kCryptomatteLevelsMax}) {
    spec.cryptomatte_levels = levels;
    EXPECT_THAT(NamesOf(spec), testing::ElementsAre("", kSamplesLayer, kNoiseLayer)) << levels;
  }
}

TEST(PictureLayers, OfASpectralFilmAreItsRanges) {
  FrameSpec spec;
  for (const char* name : {"S0.400,000nm", "S0.500,000nm", "S0.600,000nm", "S0.700,000nm"})
    AddChannel(spec.channels, {name, ChannelType::kColor, MergeRule::kSum, true});
  EXPECT_EQ(FindLayer(spec, "S0.500,000nm")->channels, std::vector<std::string>{"S0.500,000nm"});
}

TEST(PictureLayers, AReaderSeesTheValuesOfTheFile) {
  const FrameSpec spec = Layered();
  Merger merger(spec);
  for (int tile = 0; tile < spec.TileCount(); ++tile)
    ASSERT_TRUE(merger.Add(Node(spec, tile, {0, 1}, static_cast<float>(tile))));
  const FramePicture picture = merger.Picture();
  for (const char* name : {"albedo", "heat", kLightsLayer}) {
    const PictureLayer layer = *FindLayer(spec, name);
    PictureBoard board(name);
    board.Show(merger.Snapshot());
    ShownPicture reader;
    reader.Receive(board);
    ASSERT_EQ(reader.shape.channels, layer.channels.size());
    EXPECT_EQ(reader.shape.type, layer.is_exact ? ExrType::kFloat : ExrType::kHalf);
    for (size_t c = 0; c < layer.channels.size(); ++c) {
      const std::vector<float> expected = picture.Channel(layer.channels[c]);
      for (size_t p = 0; p < expected.size(); p += 97)
        ASSERT_EQ(reader.values[p * layer.channels.size() + c], expected[p]) << layer.channels[c] << " " << p;
    }
  }
}

TEST(PictureLayers, ALargeFrameWithManyLightGroupsHasABoundedNumberOfValues) {
  FrameSpec spec = Layered();
  spec.width = spec.height = 4096;
  spec.crop = {0, 0, 4096, 4096};
  const PictureLayer lights = *FindLayer(spec, kLightsLayer);
  const PictureShape shape = ShapeOf(spec, lights, kLiveValuesMax);
  EXPECT_LE(int64_t{shape.width} * shape.height * 6, kLiveValuesMax);
}

TEST(PictureLayers, SamplesAreThoseThatEachTileShows) {
  const FrameSpec spec = Layered();
  Merger merger(spec);
  ASSERT_TRUE(merger.Add(Node(spec, 0, {0, 2}, 1)));
  ASSERT_TRUE(merger.Add(Node(spec, 0, {2, 1}, 1)));
  ASSERT_TRUE(merger.Add(Node(spec, 1, {0, 1}, 1)));
  ASSERT_TRUE(merger.Add(Node(spec, 1, {2, 2}, 1)));
  PictureBoard board(kSamplesLayer);
  board.Show(merger.Snapshot());
  ShownPicture reader;
  reader.Receive(board);
  EXPECT_EQ(reader.shape.channels, 1u);
  EXPECT_EQ(reader.values[0], 3);
  EXPECT_EQ(reader.values[40], 1) << "what comes after a gap is not shown yet";
  EXPECT_EQ(reader.values.back(), 0);
}

TEST(PictureLayers, NoiseIsWhatTwoPartsOfTheSamplesDifferBy) {
  const FrameSpec spec = Layered();
  Merger merger(spec);
  ASSERT_TRUE(merger.Add(Node(spec, 0, {0, 2}, 9)));
  PictureBoard board(kNoiseLayer);
  board.Show(merger.Snapshot());
  ShownPicture reader;
  reader.Receive(board);
  EXPECT_EQ(reader.values[0], 0) << "one part tells nothing";
  ASSERT_TRUE(merger.Add(Node(spec, 0, {2, 1}, 12)));
  board.Show(merger.Snapshot());
  reader.Receive(board);
  // R is 9 in two samples and 12 in the third; G and B are 1 and 2 larger.
  double expected = 0;
  for (const double mean : {10.0, 11.0, 12.0}) expected += 9.0 * 2 * 1 / 9 / (mean * mean + 0.01) / 3;
  EXPECT_NEAR(reader.values[0], std::sqrt(expected), 1e-4);
  const float known = reader.values[0];
  ASSERT_TRUE(merger.Add(Node(spec, 0, {3, 1}, 12)));
  board.Show(merger.Snapshot());
  reader.Receive(board);
  EXPECT_EQ(reader.values[0], known) << "what is known stays while the parts have become one";
}

TEST(PictureLayers, TheNoiseOfAPictureWithVarianceIsExact) {
  FrameSpec spec;
  spec.width = spec.height = 8;
  spec.crop = {0, 0, 8, 8};
  spec.samples_per_pixel = 4;
  spec.exr_type = ExrType::kFloat;
  LoadedPicture file;
  file.bounds = spec.crop;
  file.channels = {"B", "G", "R", "variance.B", "variance.G", "variance.R"};
  for (int p = 0; p < 64; ++p) file.values.insert(file.values.end(), {1, 2, 3, 0.1f, 0.2f, 0.3f});
  PictureBoard board(kNoiseLayer);
  board.Show(spec, file);
  ShownPicture reader;
  reader.Receive(board);
  EXPECT_NEAR(reader.values[0], std::sqrt((0.1 / 1.01 + 0.2 / 4.01 + 0.3 / 9.01) / 3), 1e-5);
}

TEST(PictureLayers, AFileWithoutTheLayerShowsNothing) {
  FrameSpec spec;
  spec.width = spec.height = 8;
  spec.crop = {0, 0, 8, 8};
  spec.samples_per_pixel = 4;
  LoadedPicture file;
  file.bounds = spec.crop;
  file.channels = {"B", "G", "R"};
  file.values.assign(64 * 3, 1.0f);
  for (const char* layer : {kNoiseLayer, kSamplesLayer}) {
    PictureBoard board(layer);
    board.Show(spec, file);
    ShownPicture reader;
    reader.Receive(board);
    EXPECT_EQ(reader.values[0], layer == std::string(kSamplesLayer) ? 4 : 0);
  }
}

}  // namespace
}  // namespace tessera
