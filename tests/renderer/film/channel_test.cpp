#include "renderer/film/channel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "renderer/film/channel_layout.h"
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
    ASSERT_TRUE(CheckChannels(channels));
    bad.spoil(channels);
    const auto checked = CheckChannels(channels);
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
  EXPECT_EQ(PictureChannels(spec.channels).size(), 3u) << "they are not written unless asked for";
}

}  // namespace
}  // namespace tessera
