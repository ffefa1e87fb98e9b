#include "client/frame_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/command_line.h"
#include "client/frame_fetcher.h"
#include "client/frame_names.h"
#include "client/scene_frames.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(FrameRange, IsFirstLastAndStep) {
  EXPECT_THAT(ParseFrameRange("3-6")->Numbers(), ElementsAre(3, 4, 5, 6));
  EXPECT_THAT(ParseFrameRange("0-10x4")->Numbers(), ElementsAre(0, 4, 8));
  EXPECT_THAT(ParseFrameRange("7")->Numbers(), ElementsAre(7));
  EXPECT_THAT(ParseFrameRange("7-7x3")->Numbers(), ElementsAre(7));
  EXPECT_THAT(ParseFrameRange("99999998-99999999")->Numbers(), ElementsAre(99'999'998, 99'999'999));
}

TEST(FrameRange, WhatIsNoneIsRefusedInWords) {
  for (const char* word : {"", "-", "a", "1-", "-3", "1--3", "1-3x", "1-3x-1", "1-3y2", "1-3 ", "1,3",
                           "1-99999999999999999999", "0-100000000"}) {
    const auto range = ParseFrameRange(word);
    ASSERT_FALSE(range) << word;
    EXPECT_THAT(range.error().message, HasSubstr("A-BxSTEP")) << word;
  }
  EXPECT_THAT(ParseFrameRange("5-4").error().message, HasSubstr("before the first"));
  EXPECT_THAT(ParseFrameRange("1-4x0").error().message, HasSubstr("at least 1"));
  EXPECT_THAT(ParseFrameRange("1-10001").error().message, HasSubstr("10001 frames are more than the 10000"));
  EXPECT_TRUE(ParseFrameRange("1-10000"));
}

TEST(FrameNames, NumbersTakeThePlaceOfHashesAndOfPrintfsPlaces) {
  EXPECT_EQ(NameOfFrame("scene.####.pbrt", 7), "scene.0007.pbrt");
  EXPECT_EQ(NameOfFrame("scene.#.pbrt", 123), "scene.123.pbrt");
  EXPECT_EQ(NameOfFrame("###/scene.##.pbrt", 7), "007/scene.07.pbrt");
  EXPECT_EQ(NameOfFrame("scene%03d.pbrt", 7), "scene007.pbrt");
  EXPECT_EQ(NameOfFrame("scene%d.pbrt", 7), "scene7.pbrt");
  EXPECT_EQ(NameOfFrame("100%.%x.%0d.%099d.pbrt", 7), "100%.%x.%0d.%099d.pbrt");
  EXPECT_TRUE(IsFramePattern("a%4d#"));
  EXPECT_FALSE(IsFramePattern("a%4d%"));
}

TEST(FrameNames, ANameWithoutAPlaceGetsOneBeforeItsEnding) {
  EXPECT_EQ(AsFramePattern("out.exr"), "out.####.exr");
  EXPECT_EQ(AsFramePattern("dir.d/out"), "dir.d/out.####");
  EXPECT_EQ(AsFramePattern("out.##.exr"), "out.##.exr");
}

TEST(PictureNames, FollowTheFrames) {
  using Numbers = PictureNames::Numbers;
  EXPECT_EQ(PictureNames("a.exr", "a.png", Numbers::kAlways).Exr(12), "a.0012.exr");
  EXPECT_EQ(PictureNames("a.exr", "a.png", Numbers::kAlways).Png(12), "a.0012.png");
  EXPECT_EQ(PictureNames("a.exr", "", Numbers::kAlways).Png(12), "");
  EXPECT_EQ(PictureNames("a.exr", "", Numbers::kInPlace).Exr(12), "a.exr");
  EXPECT_EQ(PictureNames("a#.exr", "", Numbers::kInPlace).Exr(12), "a12.exr");
  EXPECT_EQ(PictureNames("a#.exr", "", Numbers::kNone).Exr(12), "a#.exr");
}

Options ParsedOptions(std::vector<std::string> words) {
  const auto parsed = ParseCommandLine(words);
  EXPECT_TRUE(parsed) << parsed.error().message;
  return parsed ? parsed->options : Options();
}

TEST(ListFrames, GivesEachFrameItsFile) {
  const auto frames = ListFrames(ParsedOptions({"render", "shot/scene.###.pbrt", "--frames", "8-12x2"}));
  ASSERT_TRUE(frames);
  ASSERT_EQ(frames->size(), 3u);
  EXPECT_EQ((*frames)[1].number, 10);
  EXPECT_EQ((*frames)[1].path, "shot/scene.010.pbrt");
  EXPECT_EQ((*frames)[1].folder(), "shot");
  EXPECT_EQ((*frames)[1].name(), "scene.010.pbrt");
  EXPECT_FALSE((*frames)[1].is_animated);
  EXPECT_FALSE((*frames)[1].options.time);
}

TEST(ListFrames, GivesTheFramesOfOneSceneTheirTimes) {
  const auto frames = ListFrames(ParsedOptions({"render", "scene.pbrt", "--frames", "0-24"}));
  ASSERT_TRUE(frames);
  EXPECT_EQ((*frames)[12].path, "scene.pbrt");
  EXPECT_EQ((*frames)[12].options.time, 0.5);
  EXPECT_EQ((*ListFrames(ParsedOptions({"render", "s", "--frames", "30", "--fps", "60"})))[0].options.time,
            0.5);
}

TEST(ListFrames, APatternWithoutFramesAsksForThem) {
  const auto frames = ListFrames(ParsedOptions({"render", "scene.####.pbrt"}));
  ASSERT_FALSE(frames);
  EXPECT_THAT(frames.error().message, HasSubstr("--frames A-B"));
}

TEST(ListFrames, OneSceneIsOneFrameWithoutATime) {
  const auto frames = ListFrames(ParsedOptions({"render", "scene.pbrt"}));
  ASSERT_TRUE(frames);
  ASSERT_EQ(frames->size(), 1u);
  EXPECT_FALSE((*frames)[0].options.time);
}

}  // namespace
}  // namespace tessera
