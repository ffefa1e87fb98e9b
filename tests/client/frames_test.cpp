#include "proto/frame_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/picture_names.h"
#include "client/scene_frames.h"
#include "proto/frame_name.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(FrameRange, IsFirstLastAndStep) {
  EXPECT_THAT(ParseFrameRange("--frames", "3-6")->Numbers(), ElementsAre(3, 4, 5, 6));
  EXPECT_THAT(ParseFrameRange("--frames", "0-10x4")->Numbers(), ElementsAre(0, 4, 8));
  EXPECT_THAT(ParseFrameRange("--frames", "7")->Numbers(), ElementsAre(7));
  EXPECT_THAT(ParseFrameRange("--frames", "7-7x3")->Numbers(), ElementsAre(7));
  EXPECT_THAT(ParseFrameRange("--frames", "99999998-99999999")->Numbers(),
              ElementsAre(99'999'998, 99'999'999));
}

TEST(FrameRange, RefusesWhatIsNotARange) {
  for (const char* word : {"", "-", "a", "1-", "-3", "1--3", "1-3x", "1-3x-1", "1-3y2", "1-3 ", "1,3",
                           "1-99999999999999999999", "0-100000000"}) {
    const auto range = ParseFrameRange("--frames", word);
    ASSERT_FALSE(range) << word;
    EXPECT_THAT(range.error().message, HasSubstr("A-BxSTEP")) << word;
  }
  EXPECT_THAT(ParseFrameRange("--frames", "5-4").error().message, HasSubstr("before the first"));
  EXPECT_THAT(ParseFrameRange("--frames", "1-4x0").error().message, HasSubstr("at least 1"));
  EXPECT_THAT(ParseFrameRange("--frames", "1-10001").error().message,
              HasSubstr("10001 frames; a job has at most 10000"));
  EXPECT_TRUE(ParseFrameRange("--frames", "1-10000"));
}

TEST(FrameName, PutsTheNumberInPlaceOfHashesAndPrintfFormats) {
  EXPECT_EQ(FrameName("scene.####.pbrt").Of(7), "scene.0007.pbrt");
  EXPECT_EQ(FrameName("scene.#.pbrt").Of(123), "scene.123.pbrt");
  EXPECT_EQ(FrameName("scene%03d.pbrt").Of(7), "scene007.pbrt");
  EXPECT_EQ(FrameName("scene%d.pbrt").Of(7), "scene7.pbrt");
  EXPECT_EQ(FrameName("#%d#").Of(7), "777");
  EXPECT_EQ(FrameName("100%.%x.%0d.%099d.pbrt").Of(7), "100%.%x.%0d.%099d.pbrt");
  EXPECT_EQ(FrameName("").Of(7), "");
  EXPECT_TRUE(FrameName("a%4d#").HasPlace());
  EXPECT_FALSE(FrameName("a%4d%").HasPlace());
}

TEST(FrameName, HasNoPlacesInItsFolders) {
  EXPECT_EQ(FrameName("job#3/out.##.exr").Of(7), "job#3/out.07.exr");
  EXPECT_EQ(FrameName("/a%d/b###/c").Of(7), "/a%d/b###/c");
  EXPECT_FALSE(FrameName("proj#1/scene.pbrt").HasPlace());
  EXPECT_EQ(FrameName("job#3/out.exr").WithPlace().text(), "job#3/out.####.exr");
}

TEST(FrameName, GetsAPlaceBeforeItsExtensionIfItHasNone) {
  EXPECT_EQ(FrameName("out.exr").WithPlace().text(), "out.####.exr");
  EXPECT_EQ(FrameName("dir.d/out").WithPlace().text(), "dir.d/out.####");
  EXPECT_EQ(FrameName("out.##.exr").WithPlace().text(), "out.##.exr");
}

TEST(PictureNames, FollowTheFrames) {
  using Numbers = PictureNames::Numbers;
  EXPECT_EQ(PictureNames("a.exr", "a.png", Numbers::kAlways).Picture(12), "a.0012.exr");
  EXPECT_EQ(PictureNames("a.exr", "a.png", Numbers::kAlways).Png(12), "a.0012.png");
  EXPECT_EQ(PictureNames("a.exr", "", Numbers::kAlways).Png(12), "");
  EXPECT_EQ(PictureNames("a.exr", "", Numbers::kInPlace).Picture(12), "a.exr");
  EXPECT_EQ(PictureNames("a#.exr", "", Numbers::kInPlace).Picture(12), "a12.exr");
  EXPECT_EQ(PictureNames("a#.exr", "", Numbers::kNone).Picture(12), "a#.exr");
}

TEST(PictureNames, KeepTheNameOfADevice) {
  const PictureNames names("/dev/null", "/dev/null", PictureNames::Numbers::kAlways);
  EXPECT_EQ(names.Picture(12), "/dev/null");
  EXPECT_TRUE(names.Check({1, 2, 3}));
}

TEST(PictureNames, AreRefusedIfTheEndingDoesNotSayWhatIsWritten) {
  const std::string folder = testing::TempDir();
  const auto check = [&](const std::string& picture, const std::string& png) {
    return PictureNames(folder + picture, png.empty() ? "" : folder + png, PictureNames::Numbers::kNone)
        .Check({0});
  };
  EXPECT_TRUE(check("a.jpg", "a.PNG"));
  EXPECT_TRUE(check("a", ""));
  EXPECT_THAT(check("a.pbrt", "").error().message, HasSubstr("a.pbrt: cannot write pictures of type .pbrt"));
  EXPECT_THAT(check("a.exr", "a.jpg").error().message, HasSubstr("must end in .png"));
  EXPECT_THAT(check("a.png", "a.png").error().message, HasSubstr("two pictures"));
}

TEST(SceneName, IsThatOfTheFileWithoutExtensions) {
  const auto name = [](const char* path) {
    SceneOptions options;
    options.path = path;
    return SceneName(options);
  };
  EXPECT_EQ(name("shots/box.pbrt"), "box");
  EXPECT_EQ(name("box.pbrt.gz"), "box");
  EXPECT_EQ(name("BOX.pbrt.GZ"), "BOX");
  EXPECT_EQ(name("box"), "box");
  EXPECT_EQ(name("-"), "stdin");
}

SceneOptions Sequence(const std::string& path, FrameRange frames, double fps = kFramesPerSecondDefault) {
  SceneOptions options;
  options.path = path;
  options.frames = frames;
  options.fps = fps;
  return options;
}

TEST(ListFrames, GivesEachFrameItsFile) {
  const auto frames = ListFrames(Sequence("shot#1/scene.###.pbrt", {8, 12, 2}));
  ASSERT_TRUE(frames);
  ASSERT_EQ(frames->size(), 3u);
  EXPECT_EQ((*frames)[1].number, 10);
  EXPECT_EQ((*frames)[1].path, "shot#1/scene.010.pbrt");
  EXPECT_EQ((*frames)[1].folder(), "shot#1");
  EXPECT_EQ((*frames)[1].name(), "scene.010.pbrt");
  EXPECT_FALSE((*frames)[1].is_animated);
  EXPECT_FALSE((*frames)[1].options.time);
}

TEST(ListFrames, GivesTheFramesOfOneSceneTheirTimes) {
  const auto frames = ListFrames(Sequence("scene.pbrt", {0, 24, 1}));
  ASSERT_TRUE(frames);
  EXPECT_EQ((*frames)[12].path, "scene.pbrt");
  EXPECT_TRUE((*frames)[12].is_animated);
  EXPECT_EQ((*frames)[12].options.time, 0.5);
  EXPECT_EQ((*ListFrames(Sequence("s", {30, 30, 1}, 60)))[0].options.time, 0.5);
}

TEST(ListFrames, AsksForTheFramesOfAPattern) {
  SceneOptions options;
  options.path = "scene.####.pbrt";
  const auto frames = ListFrames(options);
  ASSERT_FALSE(frames);
  EXPECT_THAT(frames.error().message, HasSubstr("--frames A-B"));
}

TEST(ListFrames, GivesOneSceneOneFrameWithoutATime) {
  SceneOptions options;
  options.path = "scene.pbrt";
  const auto frames = ListFrames(options);
  ASSERT_TRUE(frames);
  ASSERT_EQ(frames->size(), 1u);
  EXPECT_FALSE((*frames)[0].options.time);
}

TEST(SceneMemory, ASceneThatNeedsMoreFailsWithTheLimit) {
  SceneFrame frame;
  frame.path = "large.pbrt";
  std::string text = "Camera \"perspective\"\nWorldBegin\nShape \"trianglemesh\" \"point3 P\" [";
  for (int i = 0; i < 200'000; ++i) text += " 0 0 5 1 0 5 1 1 5";
  frame.text = std::make_shared<const std::string>(text + "] \"integer indices\" [ 0 1 2 ]\n");
  EXPECT_TRUE(LoadFrame(frame, Scene::Depth::kCheck, nullptr));
  frame.memory = kSceneMemoryMin;
  const auto refused = LoadFrame(frame, Scene::Depth::kCheck, nullptr);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "large.pbrt: loading the scene needs more than 16 MiB of memory (--scene-memory)");
}

TEST(SceneMemory, IsByDefaultThatOfTheMachineAndForAllFrames) {
  SceneOptions options;
  options.path = "a.pbrt";
  const auto unlimited = ListFrames(options);
  ASSERT_TRUE(unlimited);
  EXPECT_EQ(LimitsOf(unlimited->front()).memory_bytes, UsableMemory());
  options.frames = FrameRange{1, 3, 1};
  options.scene_memory = kSceneMemoryMin;
  const auto limited = ListFrames(options);
  ASSERT_TRUE(limited);
  ASSERT_EQ(limited->size(), 3u);
  for (const SceneFrame& frame : *limited) EXPECT_EQ(LimitsOf(frame).memory_bytes, kSceneMemoryMin);
}

}  // namespace
}  // namespace tessera
