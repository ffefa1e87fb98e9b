#include "client/output/layer_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Channels in the order of a file, with values that tell them apart.
LoadedPicture Layered(std::vector<std::string> channels) {
  LoadedPicture picture;
  picture.width = 2;
  picture.height = 1;
  picture.bounds = {0, 0, 2, 1};
  picture.channels = std::move(channels);
  for (const std::string& channel : picture.channels)
    picture.types.push_back(channel.size() == 1 ? ExrType::kHalf : ExrType::kFloat);
  for (size_t i = 0; i < 2 * picture.channels.size(); ++i) picture.values.push_back(static_cast<float>(i));
  picture.attributes = {{"tessera:seed", "7"},
                        {"cryptomatte/3ae39a5/name", "CryptoObject"},
                        {"cryptomatte/3ae39a5/manifest", "{}"}};
  return picture;
}

ExrOutput With(ExrCompression compression) {
  ExrOutput output;
  output.compression = compression;
  return output;
}

TEST(LayerFiles, ChannelsOfALayerStayTogether) {
  const std::vector<std::string> mattes{"CryptoObject"};
  EXPECT_EQ(LayerOf("R", mattes), "");
  EXPECT_EQ(LayerOf("A", mattes), "");
  EXPECT_EQ(LayerOf("albedo.R", mattes), "albedo");
  EXPECT_EQ(LayerOf("samples", mattes), "samples");
  EXPECT_EQ(LayerOf("S0.414,000nm", mattes), "S0");
  EXPECT_EQ(LayerOf("CryptoObject00.R", mattes), "CryptoObject");
  EXPECT_EQ(LayerOf("CryptoObject02.A", mattes), "CryptoObject");
  EXPECT_EQ(LayerOf("CryptoObject07.A", mattes), "CryptoObject");
  EXPECT_EQ(LayerOf("light01.R", mattes), "light01");
}

TEST(LayerFiles, EachLayerIsAPictureWithTheHeaderOfTheWhole) {
  const auto layers =
      SplitLayers(Layered({"B", "CryptoObject00.R", "CryptoObject01.R", "G", "R", "albedo.R"}));
  ASSERT_TRUE(layers) << layers.error().message;
  ASSERT_EQ(layers->size(), 3u);
  EXPECT_EQ((*layers)[0].layer, "");
  EXPECT_THAT((*layers)[0].picture.channels, ElementsAre("B", "G", "R"));
  EXPECT_THAT((*layers)[0].picture.values, ElementsAre(0, 3, 4, 6, 9, 10));
  EXPECT_EQ((*layers)[0].picture.attributes, (std::map<std::string, std::string>{{"tessera:seed", "7"}}));
  EXPECT_EQ((*layers)[1].layer, "CryptoObject");
  EXPECT_THAT((*layers)[1].picture.values, ElementsAre(1, 2, 7, 8));
  EXPECT_EQ((*layers)[1].picture.attributes.size(), 3u) << "with the names of its mattes";
  EXPECT_EQ((*layers)[2].layer, "albedo");
  for (const LayerPicture& each : *layers) EXPECT_TRUE(EncodeExr(each.picture, FormatOf(each, {})));
}

TEST(LayerFiles, NamesOfFilesStayInTheirFolder) {
  EXPECT_EQ(FileLayer("../../etc/x"), "______etc_x");
  EXPECT_EQ(FileLayer("key light#%d"), "key_light__d");
  EXPECT_EQ(FileLayer(std::string(300, 'x')).size(), 64u);
  const auto layers = SplitLayers(Layered({"R", "a/b.R", "a_b.R"}));
  ASSERT_FALSE(layers) << "one file cannot hold two layers";
  EXPECT_THAT(layers.error().message, HasSubstr("a_b"));
}

TEST(LayerFiles, WhatLosesSomethingIsForColoursAlone) {
  const auto layers = *SplitLayers(Layered({"CryptoObject00.R", "R", "depth"}));
  ASSERT_EQ(layers.size(), 3u);
  EXPECT_EQ(FormatOf(layers[0], With(ExrCompression::kDwaa)).compression, ExrCompression::kDwaa);
  EXPECT_EQ(FormatOf(layers[1], With(ExrCompression::kDwaa)).compression, ExrCompression::kZip);
  EXPECT_EQ(FormatOf(layers[2], With(ExrCompression::kPxr24)).compression, ExrCompression::kZip);
  EXPECT_EQ(FormatOf(layers[1], With(ExrCompression::kPiz)).compression, ExrCompression::kPiz);
}

TEST(LayerFiles, AWholeFileHasNoCompressionThatChangesWhatMustStayExact) {
  const LoadedPicture picture = Layered({"CryptoObject00.R", "R", "depth"});
  FrameSpec frame;
  AddChannel(frame.channels, {"CryptoObject", ChannelType::kIds, MergeRule::kIdWeights});
  for (const ExrCompression compression :
       {ExrCompression::kPxr24, ExrCompression::kDwaa, ExrCompression::kDwab}) {
    EXPECT_FALSE(CheckCompression(picture, With(compression)));
    const auto refused = CheckCompression(frame, With(compression));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::kBadInput);
    EXPECT_THAT(refused.error().message, HasSubstr("CryptoObject00.R"));
    EXPECT_TRUE(CheckCompression(FrameSpec(), With(compression)));
    ExrOutput split = With(compression);
    split.splits_layers = true;
    EXPECT_TRUE(CheckCompression(frame, split));
  }
  for (const ExrCompression compression :
       {ExrCompression::kNone, ExrCompression::kPiz, ExrCompression::kB44}) {
    EXPECT_TRUE(CheckCompression(picture, With(compression)));
    EXPECT_TRUE(CheckCompression(frame, With(compression)));
  }
}

TEST(LayerFiles, TheLayersOfAFrameAreThoseOfItsPicture) {
  FrameSpec frame;
  AddChannel(frame.channels, {"CryptoObject", ChannelType::kIds, MergeRule::kIdWeights});
  AddChannel(frame.channels, SamplesChannel(true));
  frame.attributes["cryptomatte/3ae39a5/name"] = "CryptoObject";
  EXPECT_THAT(FileLayersOf(frame), ElementsAre("CryptoObject", "samples"));
}

}  // namespace
}  // namespace tessera
