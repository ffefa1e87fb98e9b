#include "renderer/film/channel.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>

#include "renderer/film/channel_layout.h"
#include "renderer/film/tile_painter.h"
#include "tests/renderer/film/rule_frames.h"

namespace tessera {
namespace {

using Channels = std::vector<Channel>;

TEST(Channel, AListThatMakesNoSenseIsRefusedByName) {
  const struct {
    const char* name;
    std::function<void(Channels&)> spoil;
    const char* message;
  } cases[] = {
      {"no weight", [](Channels& c) { c.pop_back(); }, "filter weight"},
      {"two weights",
       [](Channels& c) {
         c.push_back({"V", ChannelType::kWeight, MergeRule::kSum, false});
       },
       "filter weight"},
      {"written weight", [](Channels& c) { c.back().is_written = true; }, "never written"},
      {"no name", [](Channels& c) { c[0].name = ""; }, "name is empty"},
      {"long name", [](Channels& c) { c[0].name = std::string(256, 'x'); }, "at most 255"},
      {"the same name twice", [](Channels& c) { c[1].name = "R"; }, "twice"},
      {"depth as a sum", [](Channels& c) { c[0].type = ChannelType::kDepth; }, "do not go together"},
      {"ids as a sum", [](Channels& c) { c[0].type = ChannelType::kIds; }, "do not go together"},
      {"nearest without depth", [](Channels& c) { c[0].rule = MergeRule::kNearest; }, "depth"},
      {"two depths",
       [](Channels& c) {
         AddChannel(c, {"Z", ChannelType::kDepth, MergeRule::kNearest});
         AddChannel(c, {"Y", ChannelType::kDepth, MergeRule::kNearest});
       },
       "depth"},
      {"a count of another name", [](Channels& c) { c[0].type = ChannelType::kCount; }, "\"samples\""},
      {"samples that are no count", [](Channels& c) { c[0].name = "samples"; }, "\"samples\""},
      {"nothing written",
       [](Channels& c) {
         for (Channel& channel : c) channel.is_written = false;
       },
       "written"},
      {"a colour with the name of a rank",
       [](Channels& c) {
         AddChannel(c, {"object", ChannelType::kIds, MergeRule::kIdWeights});
         c[0].name = "object01.B";
       },
       "there twice"},
      {"too many", [](Channels& c) { c.resize(kChannelsMax + 1); }, "2 to 256"},
  };
  for (const auto& bad : cases) {
    Channels channels = ColorsAndWeight({"R", "G", "B"});
    ASSERT_TRUE(CheckChannels(channels, kCryptomatteLevelsDefault));
    bad.spoil(channels);
    const auto checked = CheckChannels(channels, kCryptomatteLevelsDefault);
    ASSERT_FALSE(checked) << bad.name;
    EXPECT_THAT(checked.error().message, testing::HasSubstr(bad.message)) << bad.name;
  }
}

TEST(Channel, WhatIsWrittenWithTheHelpOfOthersNeedsThem) {
  const struct {
    const char* name;
    std::function<void(Channels&)> add;
    const char* message;
  } cases[] = {
      {"a variance of no colour",
       [](Channels& c) {
         AddChannel(c, {"variance.Y", ChannelType::kVariance});
       },
       "needs a channel \"Y\""},
      {"means over hits without their weight",
       [](Channels& c) {
         AddChannel(c, {"u", ChannelType::kHitFloat});
       },
       "of the samples that hit a surface"},
      {"a vector of two components",
       [](Channels& c) {
         AddChannel(c, {"N.X", ChannelType::kDirection});
         AddChannel(c, {"N.Y", ChannelType::kDirection});
       },
       "needs a channel \"N.Z\""},
      {"squares without sums",
       [](Channels& c) {
         AddChannel(c, {"Variance.R", ChannelType::kHitSquare});
       },
       "needs a channel \"Variance.R.sum\""},
      {"a weight of hits that is written",
       [](Channels& c) {
         AddChannel(c, {"hit.W", ChannelType::kHitWeight});
       },
       "never written"},
      {"two weights of hits",
       [](Channels& c) {
         AddChannel(c, {"hit.W", ChannelType::kHitWeight, MergeRule::kSum, false});
         AddChannel(c, {"hit.V", ChannelType::kHitWeight, MergeRule::kSum, false});
       },
       "at most one weight"},
      {"a variance of the nearest sample",
       [](Channels& c) {
         AddChannel(c, {"variance.R", ChannelType::kVariance, MergeRule::kNearest});
       },
       "do not go together"},
  };
  for (const auto& bad : cases) {
    Channels channels = ColorsAndWeight({"R", "G", "B"});
    bad.add(channels);
    const auto checked = CheckChannels(channels, kCryptomatteLevelsDefault);
    ASSERT_FALSE(checked) << bad.name;
    EXPECT_THAT(checked.error().message, testing::HasSubstr(bad.message)) << bad.name;
  }
}

TEST(Channel, NamesOfEarlierReleasesGetTheirTypes) {
  Channels expected = ColorsAndWeight({"R", "G", "B"});
  EXPECT_EQ(ChannelsFromNames({"R", "G", "B", "W"}, false), expected);
  AddChannel(expected, SamplesChannel(true));
  EXPECT_EQ(ChannelsFromNames({"R", "G", "B", "W"}, true), expected);
  EXPECT_EQ(ChannelsFromNames({"R", "G", "B", "samples", "W"}, true), expected);
  expected[3].is_written = false;
  EXPECT_EQ(ChannelsFromNames({"R", "G", "B", "samples", "W"}, false), expected);
}

TEST(Channel, IsThereOnceIfOneOfTwoIsNotWritten) {
  const Channel hidden{"depth.Z", ChannelType::kDepth, MergeRule::kNearest, false};
  Channel shown = hidden;
  shown.is_written = true;
  for (const auto& [first, second] : {std::pair(hidden, shown), std::pair(shown, hidden)}) {
    Channels channels = ColorsAndWeight({"R"});
    AddChannel(channels, first);
    AddChannel(channels, second);
    EXPECT_EQ(channels.size(), 3u);
    EXPECT_EQ(channels[1], shown);
  }
}

// Two samples of weight 2 and one of weight -1, two of which hit something.
TEST(TilePainter, PaintsWhatIsDerivedOfSums) {
  Channels channels = ColorsAndWeight({"R"});
  AddChannel(channels, {"variance.R", ChannelType::kVariance});
  AddChannel(channels, {"hit.W", ChannelType::kHitWeight, MergeRule::kSum, false});
  AddChannel(channels, {"u", ChannelType::kHitFloat});
  AddChannel(channels, {"dzdx", ChannelType::kHitSlope});
  for (const char* name : {"N.X", "N.Y", "N.Z"}) AddChannel(channels, {name, ChannelType::kDirection});
  AddChannel(channels, {"hit.samples", ChannelType::kHitCount, MergeRule::kSum, false});
  AddChannel(channels, {"Variance.R.sum", ChannelType::kHitSum, MergeRule::kSum, false});
  AddChannel(channels, {"Variance.R", ChannelType::kHitSquare});
  ASSERT_TRUE(CheckChannels(channels, kCryptomatteLevelsDefault));
  const ChannelLayout layout(channels, false);
  std::vector<float> record(layout.shape().stride());
  const auto set = [&](const char* name, float value) { record[*layout.SlotOf(name)] = value; };
  set("R", 2 * 1 + 2 * 3 - 1 * 2);
  set("W", 2 + 2 - 1);
  set("variance.R", 4 + 36 + 4);
  set("hit.W", 4);
  set("u", 2 * 0.25f + 2 * 0.75f);
  set("dzdx", 2 * -0.5f + 2 * 0.25f);
  set("N.X", 3);
  set("N.Z", -4);
  set("hit.samples", 2);
  set("Variance.R.sum", 1 + 3);
  set("Variance.R", 1 + 9);
  const TilePainter painter(PictureChannels(channels, kCryptomatteLevelsDefault), layout);
  PixelSource pixel(layout, 1, record, 3);
  pixel.Next();
  const std::vector<std::string> names = painter.Names();
  std::vector<float> painted(names.size());
  painter.Paint(pixel, painted.data());
  std::map<std::string, float> value;
  for (size_t i = 0; i < names.size(); ++i) value[names[i]] = painted[i];
  EXPECT_FLOAT_EQ(value["R"], 2);
  // The variance of 2, 6 and -2 is 16; of their sum 48; divided by the square of the weight.
  EXPECT_FLOAT_EQ(value["variance.R"], 48.0f / 9);
  EXPECT_FLOAT_EQ(value["u"], 0.5f);
  EXPECT_FLOAT_EQ(value["dzdx"], 0.125f);
  EXPECT_FLOAT_EQ(value["N.X"], 0.6f);
  EXPECT_FLOAT_EQ(value["N.Z"], -0.8f);
  EXPECT_FLOAT_EQ(value["Variance.R"], 2);
  EXPECT_FLOAT_EQ(value["RelativeVariance.R"], 1);
  EXPECT_EQ(value.size(), 9u) << "weights, counts and sums are not written";

  std::ranges::fill(record, 0.0f);
  PixelSource empty(layout, 1, record, 0);
  empty.Next();
  painter.Paint(empty, painted.data());
  for (size_t i = 0; i < names.size(); ++i) EXPECT_EQ(painted[i], 0) << names[i];
}

TEST(ChannelLayout, GroupsChannelsByRuleAndPutsTheDepthFirst) {
  const FrameSpec spec = RuleSpec(4);
  const ChannelLayout layout = spec.Layout();
  EXPECT_EQ(layout.shape(), (PixelShape{6, 2, 2}));
  size_t slot = 0;
  for (const char* name : {"R", "G", "B", "albedo.R", "normal.x", "W", "Z", "near.R", "object", "material"})
    EXPECT_EQ(layout.SlotOf(name), slot++) << name;
  EXPECT_EQ(layout.SlotOf("samples"), std::nullopt) << "each pixel gets all";
  EXPECT_EQ(layout.SlotOf("nothing"), std::nullopt);
  EXPECT_EQ(layout.weight(), 5u);
  EXPECT_THAT(layout.colors(), testing::ElementsAre(0, 1, 2));
  EXPECT_EQ(layout.IdSetOf(7), 1u) << "the material";
}

TEST(ChannelLayout, AnAdaptiveFrameCountsItsSamplesBeforeTheWeight) {
  FrameSpec spec;
  spec.SetNoiseThreshold(0.1);
  const ChannelLayout layout = spec.Layout();
  EXPECT_EQ(layout.samples(), 3u);
  EXPECT_EQ(layout.weight(), 4u);
  EXPECT_EQ(spec.PictureChannels().size(), 3u) << "they are not written unless asked for";
}

TEST(ChannelLayout, APictureHasTwoRanksOfIdsForEachLevel) {
  FrameSpec spec = RuleSpec(4);
  ASSERT_TRUE(spec.Check());
  const size_t others = spec.PictureChannels().size() - 2 * size_t{4 * kCryptomatteLevelsDefault};
  for (uint32_t levels = 1; levels <= kCryptomatteLevelsMax; ++levels) {
    spec.cryptomatte_levels = levels;
    EXPECT_TRUE(spec.Check()) << levels;
    std::vector<std::string> names;
    uint32_t ranks = 0;
    for (const PictureChannel& channel : spec.PictureChannels()) {
      if (channel.name.starts_with("object")) {
        names.push_back(channel.name);
        ranks = std::max(ranks, channel.rank + 1);
        EXPECT_TRUE(channel.is_exact) << channel.name;
      }
    }
    EXPECT_EQ(spec.PictureChannels().size(), others + 2 * size_t{4 * levels}) << "two channels of ids";
    EXPECT_EQ(ranks, 2 * levels);
    EXPECT_EQ(names.front(), "object00.R");
    EXPECT_EQ(names.back(), fmt::format("object{:02}.A", levels - 1));
  }
}

TEST(FrameSpec, HasOneToEightLevelsOfCryptomatte) {
  FrameSpec spec = RuleSpec(4);
  for (const uint32_t levels : {0u, kCryptomatteLevelsMax + 1, 0x80000003u, 0xffffffffu}) {
    spec.cryptomatte_levels = levels;
    const auto checked = spec.Check();
    ASSERT_FALSE(checked) << levels;
    EXPECT_THAT(checked.error().message, testing::HasSubstr("levels of Cryptomatte; there must be 1 to 8"));
  }
}

// One that fits beside three levels does not fit beside four.
TEST(FrameSpec, AChannelWithTheNameOfARankIsRefused) {
  FrameSpec spec = RuleSpec(4);
  AddChannel(spec.channels, {"object03.R"});
  EXPECT_TRUE(spec.Check());
  spec.cryptomatte_levels = 4;
  EXPECT_FALSE(spec.Check());
}

}  // namespace
}  // namespace tessera
