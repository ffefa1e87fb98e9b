// Sequences of frames.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Frames : public EndToEnd {
 protected:
  static std::string Scene(const std::string& camera, const std::string& rest = "") {
    return "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16 Sampler \"independent\" "
           "\"integer "
           "pixelsamples\" 4\n" +
           camera + "\nCamera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\n" +
           "Material \"diffuse\" \"rgb reflectance\" [0.2 0.5 0.1]\nShape \"sphere\"\n" + rest;
  }
  static std::string LookFrom(int x) { return "LookAt " + std::to_string(x) + " 0 -4  0 0 0  0 1 0"; }
  // scene.0001.pbrt ... in the test's folder.
  void WriteSequence(int count) {
    for (int i = 1; i <= count; ++i) Write("scene.000" + std::to_string(i) + ".pbrt", Scene(LookFrom(i)));
  }
  // The picture of one frame of a sequence that is rendered without the others.
  std::string Alone(int frame, const std::string& scene = "scene.####.pbrt") {
    std::filesystem::create_directory(Path("alone"));
    const Outcome outcome = Tessera(
        {"render", scene, "--frames", std::to_string(frame), "--in-process", "-o", "alone/frame.%d.exr"});
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    return Bytes("alone/frame." + std::to_string(frame) + ".exr");
  }
  // A number of a list with spaces between them.
  static double NumberOf(const std::string& list, int index) {
    std::istringstream in(list);
    double number = 0;
    for (int i = 0; i <= index; ++i) in >> number;
    EXPECT_TRUE(in) << list;
    return number;
  }
  // The header of a picture as text, by name.
  std::map<std::string, std::string> HeaderOf(const std::string& picture) {
    const Outcome info = Tessera({"info", picture, "--json"});
    EXPECT_EQ(info.code, 0) << info.errors;
    std::map<std::string, std::string> header;
    const nlohmann::json json = nlohmann::json::parse(info.output);
    for (const auto& attribute : json.at("attributes")) header[attribute.at("name")] = attribute.at("value");
    return header;
  }
};

TEST_F(Frames, ASequenceOfFilesHasTheBitsOfItsFramesRenderedAlone) {
  WriteSequence(4);
  const Outcome farm = Tessera({"render", "scene.####.pbrt", "--frames", "1-4", "--workers", "2", "--json"});
  ASSERT_EQ(farm.code, 0) << farm.errors;
  EXPECT_THAT(farm.output, HasSubstr("{\"frames\":[{\"frame\":1,\"output\":\"scene.0001.exr\",\"sha256\":"));
  const Outcome here =
      Tessera({"render", "scene.####.pbrt", "--frames", "1-4", "--in-process", "-o", "here.exr"});
  ASSERT_EQ(here.code, 0) << here.errors;
  EXPECT_THAT(here.errors, HasSubstr("here.####.exr: 4 frames rendered in"));
  for (int frame = 1; frame <= 4; ++frame) {
    const std::string number = "000" + std::to_string(frame);
    EXPECT_TRUE(Bytes("scene." + number + ".exr") == Alone(frame)) << frame;
    EXPECT_TRUE(Bytes("here." + number + ".exr") == Alone(frame)) << frame;
  }
  EXPECT_FALSE(Bytes("scene.0001.exr") == Bytes("scene.0002.exr"));
}

TEST_F(Frames, AnAnimatedSceneMovesFromFrameToFrame) {
  Write("scene.pbrt", Scene(LookFrom(0),
                            "ActiveTransform EndTime Translate 3 0 0 ActiveTransform All\n"
                            "Shape \"sphere\" \"float radius\" 0.5"));
  const Outcome farm = Tessera({"render", "scene.pbrt", "--frames", "0-8x4", "--fps", "8", "-o", "farm.exr"});
  ASSERT_EQ(farm.code, 0) << farm.errors;
  EXPECT_THAT(farm.errors, HasSubstr("without motion blur"));
  const Outcome here = Tessera(
      {"render", "scene.pbrt", "--frames", "0-8x4", "--fps", "8", "-o", "here.%04d.exr", "--in-process"});
  ASSERT_EQ(here.code, 0) << here.errors;
  for (const char* number : {"0000", "0004", "0008"}) {
    EXPECT_TRUE(Bytes("farm." + std::string(number) + ".exr") ==
                Bytes("here." + std::string(number) + ".exr"));
  }
  EXPECT_FALSE(Bytes("farm.0000.exr") == Bytes("farm.0004.exr"));
  EXPECT_FALSE(Bytes("farm.0004.exr") == Bytes("farm.0008.exr"));
}

TEST_F(Frames, HeadersStateTheFrameAndWhereTheCameraIs) {
  Write("scene.pbrt", Scene("ActiveTransform EndTime Translate 3 0 0 ActiveTransform All " + LookFrom(0)));
  const std::vector<std::string> words{"render", "scene.pbrt", "--frames", "0-8x8", "--fps", "8"};
  auto farm = words, here = words;
  farm.insert(farm.end(), {"-o", "farm.exr", "--workers", "2"});
  here.insert(here.end(), {"-o", "here.exr", "--in-process"});
  ASSERT_EQ(Tessera(farm).code, 0);
  ASSERT_EQ(Tessera(here).code, 0);
  for (const char* number : {"0000", "0008"})
    EXPECT_TRUE(Bytes("farm." + std::string(number) + ".exr") ==
                Bytes("here." + std::string(number) + ".exr"));
  const auto first = HeaderOf("farm.0000.exr"), last = HeaderOf("farm.0008.exr");
  EXPECT_EQ(first.at("frame"), "0");
  EXPECT_EQ(last.at("frame"), "8");
  EXPECT_EQ(last.at("framesPerSecond"), "8/1");
  EXPECT_EQ(last.at("timeCode"), "00:00:01:00");
  EXPECT_NEAR(NumberOf(first.at("worldToCamera"), 12), 0, 1e-5) << "the way to the right, of a row vector";
  EXPECT_NEAR(NumberOf(last.at("worldToCamera"), 12), 3, 1e-5);
  EXPECT_NEAR(NumberOf(last.at("worldToCamera"), 14), 4, 1e-5);
  EXPECT_TRUE(last.contains("worldToNDC"));
}

TEST_F(Frames, FoldersAreNoPatterns) {
  std::filesystem::create_directory(Path("out#%d"));
  Write("proj#1/scene.1.pbrt", Scene(LookFrom(0), "Include \"more.pbrt\""));
  Write("proj#1/scene.2.pbrt", Scene(LookFrom(2), "Include \"more.pbrt\""));
  Write("proj#1/more.pbrt", "Translate 1 0 0 Shape \"sphere\"");
  for (const char* way : {"--in-process", "--workers=1"}) {
    const Outcome all =
        Tessera({"render", "proj#1/scene.#.pbrt", "--frames", "1-2", "-o", "out#%d/p.%02d.exr", way});
    ASSERT_EQ(all.code, 0) << all.errors;
    EXPECT_TRUE(Bytes("out#%d/p.01.exr") == Alone(1, "proj#1/scene.#.pbrt"));
    EXPECT_TRUE(Bytes("out#%d/p.02.exr") == Alone(2, "proj#1/scene.#.pbrt"));
    std::filesystem::remove(Path("out#%d/p.01.exr"));
  }
  const Outcome one = Tessera({"render", "proj#1/scene.1.pbrt", "--in-process", "-o", "out#%d/p##.exr"});
  ASSERT_EQ(one.code, 0) << one.errors;
  EXPECT_TRUE(Exists("out#%d/p##.exr")) << "a single frame has no number";
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit("proj#1/scene.1.pbrt", {});
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  const Outcome fetched = Ask({"fetch", job, "-o", "out#%d/f#.exr", "--png", "out#%d/f%d.png"});
  ASSERT_EQ(fetched.code, 0) << fetched.errors;
  EXPECT_TRUE(Exists("out#%d/f#.exr"));
  EXPECT_TRUE(Exists("out#%d/f%d.png"));
}

TEST_F(Frames, ABadFrameIsNamedBeforeRenderingStarts) {
  WriteSequence(4);
  Write("scene.0003.pbrt",
        Scene(LookFrom(3), "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"no.png\""));
  for (const char* way : {"--in-process", "--workers=1"}) {
    const Outcome outcome = Tessera({"render", "scene.####.pbrt", "--frames", "1-4", way});
    EXPECT_EQ(outcome.code, 2) << outcome.errors;
    EXPECT_THAT(outcome.errors,
                AllOf(HasSubstr("scene.0003.pbrt:8:35: no.png"), Not(HasSubstr("samples/s"))));
    EXPECT_FALSE(Exists("scene.0001.exr"));
  }
  const Outcome info = Tessera({"info", "scene.####.pbrt", "--frames", "1-4"});
  EXPECT_EQ(info.code, 2);
  EXPECT_THAT(info.errors, HasSubstr("scene.0003.pbrt:8:35: no.png"));
  const Outcome missing = Tessera({"render", "scene.####.pbrt", "--frames", "1-7"});
  EXPECT_EQ(missing.code, 2);
  EXPECT_THAT(missing.errors, HasSubstr("scene.0003.pbrt")) << "the first bad frame";
}

TEST_F(Frames, InfoCountsTheFramesOfASequence) {
  WriteSequence(3);
  const Outcome info = Tessera({"info", "scene.####.pbrt", "--frames", "1-3"});
  ASSERT_EQ(info.code, 0) << info.errors;
  EXPECT_THAT(info.output,
              AllOf(HasSubstr("frames      3, 1 to 3, all readable"), HasSubstr("files       3,")));
}

TEST_F(Frames, ASequenceIsFetchedAsAWholeOrByFrame) {
  WriteSequence(3);
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit("scene.####.pbrt", {"--frames", "1-3"});
  EXPECT_THAT(Ask({"watch", job}).errors, HasSubstr("3 of 3 frames"));
  const Outcome one = Ask({"fetch", job, "--frame", "2", "-o", "two.exr"});
  EXPECT_EQ(one.output, "two.exr\n") << one.errors;
  EXPECT_TRUE(Bytes("two.exr") == Alone(2));
  const std::string name = "job-" + job + ".0003.exr";
  Write(name, "half a picture");
  const Outcome all = Ask({"fetch", job});
  EXPECT_EQ(all.code, 0) << all.errors;
  for (int frame = 1; frame <= 3; ++frame) {
    EXPECT_TRUE(Bytes("job-" + job + ".000" + std::to_string(frame) + ".exr") == Alone(frame)) << frame;
  }
  const Outcome none = Ask({"fetch", job, "--frame", "9"});
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.errors, HasSubstr("has no frame 9; its frames are 1 to 3"));
}

// Needs more memory than a worker with --scene-memory 16M may use.
std::string LargeMesh() {
  std::string mesh = "Shape \"trianglemesh\" \"point3 P\" [";
  for (int i = 0; i < 300'000; ++i) mesh += " 0 0 5";
  mesh += "] \"integer indices\" [";
  for (int i = 0; i < 300'000; ++i) mesh += " " + std::to_string(i);
  return mesh + "]\n";
}

TEST_F(Frames, AFrameThatFailsIsNamedAfterTheOthersAreRendered) {
  WriteSequence(3);
  Write("scene.0002.pbrt", Scene(LookFrom(2), LargeMesh()));
  StartCoordinator({"--attempts-max", "1"});
  StartWorker("small", 1, {"--scene-memory", "16M"});
  const std::string job = Submit("scene.####.pbrt", {"--frames", "1-3"});
  const Outcome watched = Ask({"watch", job, "--preview", "preview.png"});
  EXPECT_EQ(watched.code, 1);
  EXPECT_THAT(watched.errors,
              HasSubstr("job " + job + " failed (2 of 3 frames are finished): frame 2 failed: "));
  EXPECT_EQ(Figure(job, "frames_failed"), 1);
  const Outcome fetched = Ask({"fetch", job});
  EXPECT_EQ(fetched.code, 1);
  EXPECT_THAT(fetched.errors, HasSubstr("frame 2 of job " + job + " failed; \"tessera logs " + job + "\""));
  EXPECT_TRUE(Bytes("job-" + job + ".0001.exr") == Alone(1));
  EXPECT_FALSE(Exists("job-" + job + ".0002.exr"));
  EXPECT_TRUE(Bytes("job-" + job + ".0003.exr") == Alone(3));
  EXPECT_EQ(Ask({"fetch", job, "--frame", "3", "-o", "three.exr", "--png", "three.png"}).code, 0);
  EXPECT_TRUE(Bytes("preview.png") == Bytes("three.png")) << "the failed frame is not waited for";
  const Outcome logs = Ask({"logs", job});
  EXPECT_THAT(logs.output, HasSubstr("frame 2 failed: the scene cannot be loaded"));
}

TEST_F(Frames, APreviewOfAnEndedSequenceSkipsAndNamesAFrameOfWhichNothingWasRendered) {
  WriteSequence(3);
  Write("scene.0002.pbrt", Scene(LookFrom(2), LargeMesh()));
  StartCoordinator();
  StartWorker("small", 1, {"--scene-memory", "16M"});
  const std::string job = Submit("scene.####.pbrt", {"--frames", "1-3"});
  ASSERT_TRUE(Eventually([&] { return Figure(job, "frames_finished") == 2; }));
  EXPECT_EQ(Ask({"cancel", job}).code, 0);
  const Outcome fetched = Ask({"fetch", job, "--preview"});
  EXPECT_EQ(fetched.code, 1);
  EXPECT_THAT(fetched.errors, HasSubstr("nothing was rendered of frame 2 of job " + job));
  EXPECT_TRUE(Bytes("job-" + job + ".0001.exr") == Alone(1));
  EXPECT_FALSE(Exists("job-" + job + ".0002.exr"));
  EXPECT_TRUE(Bytes("job-" + job + ".0003.exr") == Alone(3));
}

TEST_F(Frames, FetchSavesFinishedFramesAndNamesTheOthers) {
  WriteSequence(1);
  Write("scene.0002.pbrt", Scene(LookFrom(2) + " Sampler \"independent\" \"integer pixelsamples\" 1000000"));
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit("scene.####.pbrt", {"--frames", "1-2"});
  ASSERT_TRUE(Eventually([&] { return Figure(job, "frames_finished") == 1; }));
  const Outcome fetched = Ask({"fetch", job});
  EXPECT_EQ(fetched.code, 1);
  EXPECT_THAT(fetched.errors, HasSubstr("frame 2 of job " + job + " is not finished"));
  EXPECT_TRUE(Bytes("job-" + job + ".0001.exr") == Alone(1));
  EXPECT_FALSE(Exists("job-" + job + ".0002.exr"));
  EXPECT_EQ(Ask({"fetch", job, "--preview"}).code, 0);
  EXPECT_TRUE(Exists("job-" + job + ".0002.exr"));
}

}  // namespace
}  // namespace tessera
