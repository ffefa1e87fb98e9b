// The picture is bit-identical however it is rendered and whatever fails meanwhile.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <iterator>

#include "tests/build_paths.h"
#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using Bits = EndToEnd;

std::vector<std::string> With(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST_F(Bits, AreTheSameForAnyNumberOfWorkersThreadsAndTiles) {
  const std::string oracle = Oracle(BoxScene(), {});
  const std::vector<std::vector<std::string>> ways{
      {"--in-process", "--threads", "1"},
      {"--in-process", "--threads", "3", "--tile-size", "7"},
      {"--workers", "1", "--threads", "1"},
      {"--workers", "2"},
      {"--workers", "5", "--threads", "2", "--tile-size", "16"},
      {"--workers", "2", "--tile-size", "256"},
  };
  for (const auto& way : ways) {
    const Outcome outcome = Tessera(With({"render", BoxScene(), "-o", "picture.exr"}, way));
    ASSERT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_TRUE(Bytes("picture.exr") == oracle) << testing::PrintToString(way);
  }
}

TEST_F(Bits, AreTheSameForMediaThatVary) {
  std::ifstream fog(SourceDir() + "/tests/fuzz/corpus/nanovdb/two_grids.nvdb", std::ios::binary);
  Write("fog.nvdb", std::string(std::istreambuf_iterator<char>(fog), {}));
  const std::string scene = Write("media.pbrt", R"(
Film "rgb" "integer xresolution" 24 "integer yresolution" 16
Sampler "zsobol" "integer pixelsamples" 8
Camera "perspective" "float fov" 50
WorldBegin
LightSource "infinite" "rgb L" [ 0.4 0.5 0.6 ]
LightSource "point" "point3 from" [ 2 3 1 ] "rgb I" [ 20 20 20 ]
AttributeBegin
  Translate -1.2 0 5 Rotate 20 1 1 0
  MakeNamedMedium "smoke" "string type" "uniformgrid" "integer nx" 3 "integer ny" 2 "integer nz" 2
    "float density" [ 0 1 4 2 0 0 3 1 0 1 5 0 ] "rgb sigma_s" [ 1 0.4 0.2 ] "point3 p0" [ -1 -1 -1 ]
    "float temperature" [ 0 900 3000 0 0 0 2000 0 0 0 4000 0 ]
  MediumInterface "smoke" "" Material "interface" Shape "sphere"
AttributeEnd
AttributeBegin
  Translate 1.2 0 5
  MakeNamedMedium "paint" "string type" "rgbgrid" "integer nx" 2 "rgb sigma_s" [ 9 1 0 0 1 9 ] "point3 p0" [ -1 -1 -1 ]
  MediumInterface "paint" "" Material "dielectric" Shape "sphere"
AttributeEnd
AttributeBegin
  Translate -3 -1 7 Scale 6 3 2
  MakeNamedMedium "cloud" "string type" "cloud" "rgb sigma_a" [ 0 0 0 ]
  MediumInterface "cloud" "" Material "interface" Translate 0.5 0.5 0.5 Shape "sphere" "float radius" 0.5
AttributeEnd
AttributeBegin
  Translate -3 -2 -24
  MakeNamedMedium "fog" "string type" "nanovdb" "string filename" "fog.nvdb" "float scale" 0.2
  MediumInterface "fog" "" Material "interface" Translate 2.7 3.5 29.8 Shape "sphere" "float radius" 1.5
AttributeEnd
)");
  const std::string oracle = Oracle(scene, {"--threads", "1"});
  for (const auto& way : std::vector<std::vector<std::string>>{
           {"--workers", "2"}, {"--in-process", "--threads", "3", "--tile-size", "7"}}) {
    const Outcome outcome = Tessera(With({"render", scene, "-o", "picture.exr"}, way));
    ASSERT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_TRUE(Bytes("picture.exr") == oracle) << testing::PrintToString(way);
  }
}

TEST_F(Bits, DependOnTheSeedAndTheSamples) {
  const std::string oracle = Oracle(BoxScene(), {});
  EXPECT_FALSE(Oracle(BoxScene(), {"--seed", "5"}) == oracle);
  EXPECT_FALSE(Oracle(BoxScene(), {"--spp", "32"}) == oracle);
}

TEST_F(Bits, SurviveCropsAndSampleCountsThatAreNoPowerOfTwo) {
  const std::vector<std::string> options{"--crop", "0.2,0.7,0.1,0.93", "--spp", "13", "--exr-type", "float"};
  const std::string oracle = Oracle(BoxScene(), options);
  const Outcome outcome =
      Tessera(With({"render", BoxScene(), "-o", "picture.exr", "--workers", "2"}, options));
  ASSERT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_TRUE(Bytes("picture.exr") == oracle);
}

TEST_F(Bits, OfAMovingSceneAreTheSameForAnyNumberOfWorkersAndEveryAccelerator) {
  Write("moving.pbrt",
        "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 30\n"
        "Sampler \"zsobol\" \"integer pixelsamples\" 16\n"
        "ActiveTransform EndTime Rotate 5 0 1 0 ActiveTransform All\n"
        "Camera \"perspective\" \"float fov\" 60 \"float shutteropen\" 0.25\n"
        "WorldBegin LightSource \"infinite\" LightSource \"point\" \"rgb I\" [ 40 30 20 ]\n"
        "ObjectBegin \"o\" Shape \"sphere\" Shape \"disk\" \"float radius\" 2 ObjectEnd\n"
        "Translate 0 0 6 ActiveTransform EndTime Translate 2 0 0 Rotate 70 1 1 0 ActiveTransform All\n"
        "ObjectInstance \"o\" Translate -2 1 0 Shape \"cylinder\"\n");
  const std::string oracle = Oracle(Path("moving.pbrt"), {});
  const std::vector<std::vector<std::string>> ways{{"--in-process", "--threads", "3", "--tile-size", "7"},
                                                   {"--in-process", "--accelerator", "list"},
                                                   {"--workers", "2", "--accelerator", "bvh"},
                                                   {"--workers", "3", "--threads", "2"}};
  for (const auto& way : ways) {
    const Outcome outcome = Tessera(With({"render", Path("moving.pbrt"), "-o", "picture.exr"}, way));
    ASSERT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_TRUE(Bytes("picture.exr") == oracle) << testing::PrintToString(way);
  }
}

// The tiles of the box stop at different sample counts; those in shadow stop last.
const std::vector<std::string> kAdaptive{"--noise-threshold", "0.05", "--spp", "300", "--aov", "samples"};

TEST_F(Bits, OfAnAdaptiveFrameAreTheSameForAnyNumberOfWorkers) {
  const std::string oracle = Oracle(BoxScene(), kAdaptive);
  EXPECT_FALSE(oracle == Oracle(BoxScene(), {"--spp", "300", "--aov", "samples"}));
  const std::vector<std::vector<std::string>> ways{{"--in-process", "--threads", "1"},
                                                   {"--in-process", "--threads", "3"},
                                                   {"--workers", "1", "--threads", "1"},
                                                   {"--workers", "3", "--threads", "2"}};
  for (const auto& way : ways) {
    const Outcome outcome = Tessera(With(With({"render", BoxScene(), "-o", "picture.exr"}, way), kAdaptive));
    ASSERT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_TRUE(Bytes("picture.exr") == oracle) << testing::PrintToString(way);
  }
}

TEST_F(Bits, OfAnAdaptiveFrameSurviveKilledWorkersAndCoordinator) {
  const std::string job = ExpectSurvival(kAdaptive);
  EXPECT_EQ(Figure(job, "samples_done"), Figure(job, "samples_total"));
}

TEST_F(Bits, SurviveAWorkerKilledInMidFrameWhileAnotherJoins) {
  const std::string oracle = Oracle(BoxScene(), kLongRender);
  StartCoordinator();
  Process& doomed = StartWorker("doomed");
  StartWorker("steady");
  const std::string job = Submit(BoxScene(), kLongRender);
  AwaitShare(job, 0.1);
  doomed.Signal(SIGKILL);
  EXPECT_EQ(doomed.Wait(), -SIGKILL);
  EXPECT_LT(Figure(job, "samples_done"), Figure(job, "samples_total"));  // the frame was unfinished
  StartWorker("late");
  const Outcome watched = Ask({"watch", job});
  ASSERT_EQ(watched.code, 0) << watched.errors;
  ASSERT_EQ(Ask({"fetch", job, "-o", "picture.exr"}).code, 0);
  EXPECT_TRUE(Bytes("picture.exr") == oracle);
}

TEST_F(Bits, SurviveAWorkerOfRenderKilled) {
  const std::string oracle = Oracle(BoxScene(), kLongRender);
  Process render(
      folder(), "tessera",
      With({"render", BoxScene(), "-o", "picture.exr", "--workers", "3", "--threads", "1"}, kLongRender));
  std::vector<pid_t> workers;
  ASSERT_TRUE(Eventually([&] { return (workers = ChildrenOf(render.pid(), "tessera-worker")).size() == 3; }));
  ::kill(workers[1], SIGKILL);
  ASSERT_EQ(render.Wait(), 0) << render.Errors();
  EXPECT_THAT(render.Errors(), testing::HasSubstr("warning: worker 2 ended with signal 9"));
  EXPECT_TRUE(Bytes("picture.exr") == oracle);
}

TEST_F(Bits, SurviveAWorkerThatDrains) {
  const std::string oracle = Oracle(BoxScene(), kLongRender);
  StartCoordinator();
  Process& leaving = StartWorker("leaving");
  const std::string job = Submit(BoxScene(), kLongRender);
  AwaitShare(job, 0.05);
  StartWorker("staying");
  leaving.Signal(SIGTERM);
  EXPECT_EQ(leaving.Wait(std::chrono::seconds(10)), 0) << leaving.Errors();
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  ASSERT_EQ(Ask({"fetch", job, "-o", "picture.exr"}).code, 0);
  EXPECT_TRUE(Bytes("picture.exr") == oracle);
}

TEST_F(Bits, SurviveAWorkerThatHangsAndComesBack) {
  const std::string oracle = Oracle(BoxScene(), kLongRender);
  StartCoordinator();
  Process& hanging = StartWorker("hanging");
  const std::string job = Submit(BoxScene(), kLongRender);
  AwaitShare(job, 0.05);
  StartWorker("steady");
  hanging.Signal(SIGSTOP);
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  hanging.Signal(SIGCONT);  // with late results of a finished job
  ASSERT_EQ(Ask({"fetch", job, "-o", "picture.exr"}).code, 0);
  EXPECT_TRUE(Bytes("picture.exr") == oracle);
  EXPECT_EQ(Ask({"submit", BoxScene(), "--watch"}).code, 0);
  hanging.Signal(SIGTERM);
  EXPECT_EQ(hanging.Wait(std::chrono::seconds(10)), 0) << hanging.Errors();
}

TEST_F(Bits, SurviveACoordinatorKilledAndRestarted) {
  const std::string oracle = Oracle(BoxScene(), kLongRender);
  StartCoordinator();
  StartWorker("steady");
  const std::string job = Submit(BoxScene(), kLongRender);
  Process watch(folder(), "tessera", {"watch", job, "--coordinator", address()});
  AwaitShare(job, 0.1);
  coordinator().Signal(SIGKILL);
  EXPECT_EQ(coordinator().Wait(), -SIGKILL);
  StartCoordinator();  // on the same port, with the same data
  EXPECT_EQ(watch.Wait(), 0) << watch.Errors();
  ASSERT_EQ(Ask({"fetch", job, "-o", "picture.exr"}).code, 0);
  EXPECT_TRUE(Bytes("picture.exr") == oracle);
}

// File names that need mapping to package paths: in a parent folder, absolute, with special characters.
TEST_F(Bits, AreTheSameForFilesOutsideTheScenesFolder) {
  Write("shared/odd name%.pbrt", "Material \"diffuse\" \"rgb reflectance\" [ 0.2 0.6 0.3 ]\n");
  Write("shared/ball.pbrt", "Shape \"sphere\" \"float radius\" 0.5\n");
  const std::string scene =
      Write("scenes/scene.pbrt",
            "Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" 32\n"
            "LookAt 0 0 -3 0 0 0 0 1 0 Camera \"perspective\"\nWorldBegin\n"
            "LightSource \"infinite\"\nInclude \"../shared/odd name%.pbrt\"\nInclude \"" +
                Path("shared/ball.pbrt") + "\"\n");
  const std::string oracle = Oracle(scene, {});
  const Outcome outcome = Tessera({"render", scene, "-o", "picture.exr", "--workers", "2"});
  ASSERT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_TRUE(Bytes("picture.exr") == oracle);
}

}  // namespace
}  // namespace tessera
