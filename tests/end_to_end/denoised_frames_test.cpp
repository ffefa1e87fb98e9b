// Frames that are denoised when they are complete (--denoise), with the same bits on every farm whatever
// fails.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/end_to_end/denoised_pictures.h"
#include "tests/small_disk.h"

namespace tessera {
namespace {

using testing::HasSubstr;

const std::vector<std::string> kDenoised{"--denoise", "--spp", "16"};

class DenoisedFrames : public DenoisedPictures {
 protected:
  // Ends the coordinator while it denoises, or just before or after, and expects the bytes of one process
  // from the next one.
  void ExpectPictureAfter(int signal, int exit_code) {
    const std::vector<std::string> large{"--denoise", "--spp", "8", "--resolution", "240x180"};
    const std::string oracle = Oracle(BoxScene(), large);
    StartCoordinator();
    StartWorker("one");
    const std::string job = Submit(BoxScene(), large);
    ASSERT_TRUE(Eventually([&] { return Figure(job, "samples_done") == Figure(job, "samples_total"); }));
    coordinator().Signal(signal);
    EXPECT_EQ(coordinator().Wait(), exit_code);
    errors_ = coordinator().Errors();
    StartCoordinator();
    ExpectPicture(job, oracle);
  }
  void ExpectPicture(const std::string& job, const std::string& oracle) {
    ASSERT_EQ(Ask({"watch", job}).code, 0);
    ASSERT_EQ(Ask({"fetch", job, "-o", "picture.exr"}).code, 0);
    EXPECT_TRUE(Bytes("picture.exr") == oracle);
  }

  std::string errors_;  // of the coordinator that was ended
};

TEST_F(DenoisedFrames, GiveTheSamePictureForAnyNumberOfWorkersAndTiles) {
  const std::string oracle = Oracle(BoxScene(), kDenoised);
  const std::vector<std::vector<std::string>> ways{
      {"--in-process", "--threads", "3", "--tile-size", "7"},
      {"--workers", "1", "--threads", "1"},
      {"--workers", "3", "--tile-size", "16"},
      {"--resume"},
  };
  for (const auto& way : ways) {
    const Outcome outcome = Tessera(With(With({"render", BoxScene(), "-o", "picture.exr"}, way), kDenoised));
    ASSERT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_TRUE(Bytes("picture.exr") == oracle) << testing::PrintToString(way);
  }
  const LoadedPicture picture = Loaded("picture.exr");
  EXPECT_EQ(picture.attributes.at("tessera:denoiser"), "regression");
  for (const char* channel : {"noisy.R", "albedo.G", "halves.B", "normal.Z"})
    EXPECT_EQ(std::ranges::count(picture.channels, channel), 1) << channel;
}

TEST_F(DenoisedFrames, GiveWhatTheCommandMakesOfTheNoisyPicture) {
  const std::vector<std::string> exact{"--spp", "16", "--exr-type", "float"};
  Oracle(BoxScene(), With(exact, {"--aov", "denoise"}));
  const Outcome outcome = Tessera({"denoise", "oracle.exr", "-o", "denoised.exr"});
  ASSERT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_TRUE(Bytes("denoised.exr") == Oracle(BoxScene(), With(exact, {"--denoise"})));
  EXPECT_EQ(Tessera({"denoise", "denoised.exr", "-o", "twice.exr"}).code, 0);
  EXPECT_TRUE(Bytes("twice.exr") == Bytes("denoised.exr"));
}

TEST_F(DenoisedFrames, DenoiseEveryFrameOfASequenceAndAJobThatIsExtended) {
  for (const std::string number : {"1", "2"}) {
    Write("shot." + number + ".pbrt",
          "Sampler \"paddedsobol\" Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 48\n"
          "LookAt 0 1 -4 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 40\nWorldBegin\n"
          "LightSource \"distant\" \"point3 from\" [ 1 3 -2 ]\n"
          "Material \"diffuse\" Shape \"sphere\" \"float radius\" 0." +
              number + "\n");
  }
  const Outcome here = Tessera(
      With({"render", "shot.#.pbrt", "--frames", "1-2", "-o", "here.#.exr", "--in-process"}, kDenoised));
  ASSERT_EQ(here.code, 0) << here.errors;
  ASSERT_EQ(Tessera({"render", "shot.#.pbrt", "--frames", "1-2", "-o", "later.#.exr", "--in-process",
                     "--denoise", "--spp", "32"})
                .code,
            0);
  StartCoordinator();
  StartWorker("one");
  const std::string job = Submit("shot.#.pbrt", With({"--frames", "1-2"}, kDenoised));
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  ASSERT_EQ(Ask({"fetch", job, "-o", "farm.#.exr"}).code, 0);
  EXPECT_TRUE(Bytes("farm.1.exr") == Bytes("here.1.exr"));
  EXPECT_TRUE(Bytes("farm.2.exr") == Bytes("here.2.exr"));
  const Outcome extended = Ask({"extend", job, "--spp", "32"});
  ASSERT_EQ(extended.code, 0) << extended.errors;
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  ASSERT_EQ(Ask({"fetch", job, "-o", "farm.#.exr"}).code, 0);
  EXPECT_TRUE(Bytes("farm.1.exr") == Bytes("later.1.exr"));
}

// A file in the place of the folder of its pictures keeps the job from its end, as a full disk does.
TEST_F(DenoisedFrames, SurviveACoordinatorThatIsKilledBeforeThePictureIsWritten) {
  const std::string oracle = Oracle(BoxScene(), kDenoised);
  StartCoordinator();
  StartWorker("one");
  const std::string pictures = Path("data/pictures");
  ASSERT_TRUE(std::filesystem::exists(pictures));
  Write("data/pictures/1", "");
  const std::string job = Submit(BoxScene(), kDenoised);
  ASSERT_EQ(job, "1");
  ASSERT_TRUE(Eventually([&] {
    return Ask({"status", job, "--json"}).output.find("cannot be written") != std::string::npos;
  })) << "the reason is shown";
  EXPECT_EQ(Figure(job, "samples_done"), Figure(job, "samples_total"));
  coordinator().Signal(SIGKILL);
  EXPECT_EQ(coordinator().Wait(), -SIGKILL);
  std::filesystem::remove(pictures + "/1");
  StartCoordinator();
  ExpectPicture(job, oracle);
}

TEST_F(DenoisedFrames, AreWrittenWhenAFullDiskHasSpaceAgain) {
  const std::string oracle = Oracle(BoxScene(), kDenoised);
  StartCoordinator();
  StartWorker("one");
  const SmallDisk disk(Path("data/pictures"));
  if (!disk.is_mounted()) GTEST_SKIP() << "no permission to mount a file system";
  disk.Fill();
  const std::string job = Submit(BoxScene(), kDenoised);
  ASSERT_TRUE(Eventually([&] {
    return Ask({"status", job, "--json"}).output.find("No space left") != std::string::npos;
  }));
  EXPECT_NE(Ask({"fetch", job, "-o", "picture.exr"}).code, 0);
  EXPECT_FALSE(Exists("picture.exr"));
  disk.Free();
  ExpectPicture(job, oracle);
}

TEST_F(DenoisedFrames, SurviveACoordinatorThatIsKilledWhileItDenoises) {
  ExpectPictureAfter(SIGKILL, -SIGKILL);
}

// It leaves the picture to the next one, and does not call that a failure to write.
TEST_F(DenoisedFrames, SurviveACoordinatorThatIsStoppedWhileItDenoises) {
  ExpectPictureAfter(SIGTERM, 0);
  EXPECT_EQ(errors_.find("picture_delayed"), std::string::npos);
}

TEST_F(DenoisedFrames, RefuseTooFewSamplesBeforeTheyRender) {
  for (const char* way : {"--in-process", "--quick"}) {
    const Outcome refused = Tessera({"render", BoxScene(), "-o", "p.exr", "--denoise", "--spp", "4", way});
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.errors,
                HasSubstr("box.pbrt: is rendered with 4 samples per pixel; denoising needs at least 8"));
    EXPECT_FALSE(Exists("p.exr"));
  }
}

// A library of the tests stands for Open Image Denoise, on the machine of the coordinator as well.
TEST_F(DenoisedFrames, UseTheOpenImageDenoiseOfTheCoordinator) {
  const std::vector<std::string> with_oidn{"--denoiser", "oidn", "--spp", "8"};
  const Outcome missing = Tessera(With({"render", BoxScene(), "-o", "p.exr"}, with_oidn));
  if (missing.code == 0) GTEST_SKIP() << "Open Image Denoise is installed";
  EXPECT_THAT(missing.errors, HasSubstr("install Open Image Denoise 1.4 or 2"));
  StartCoordinator();
  StartWorker("one");
  const Outcome refused = Ask(With({"submit", BoxScene()}, with_oidn));
  EXPECT_NE(refused.code, 0);
  EXPECT_THAT(refused.errors,
              HasSubstr("the coordinator cannot denoise the pictures: Open Image Denoise cannot"));
  ASSERT_EQ(::setenv("LD_LIBRARY_PATH", (BinaryDir() + "/tests/oidn/new").c_str(), 1), 0);
  coordinator().Signal(SIGTERM);
  EXPECT_EQ(coordinator().Wait(), 0);
  StartCoordinator();
  const std::string oracle = Oracle(BoxScene(), with_oidn), job = Submit(BoxScene(), with_oidn);
  EXPECT_EQ(Loaded("oracle.exr").attributes.at("tessera:denoiser"), "oidn 2.3.3");
  EXPECT_EQ(Ask({"watch", job}).code, 0);
  EXPECT_EQ(Ask({"fetch", job, "-o", "picture.exr"}).code, 0);
  ::unsetenv("LD_LIBRARY_PATH");
  EXPECT_TRUE(Bytes("picture.exr") == oracle);
}

TEST_F(DenoisedFrames, WritePicturesWithoutLayers) {
  const Outcome outcome = Tessera(With({"render", BoxScene(), "-o", "p.png", "--in-process"}, kDenoised));
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_FALSE(Bytes("p.png").empty());
}

TEST_F(DenoisedFrames, ReplaceNoFileOfALayerThatIsToBeKept) {
  Write("p.noisy.exr", "kept");
  const Outcome refused = Tessera(
      With({"render", BoxScene(), "-o", "p.exr", "--in-process", "--aov-split", "--no-clobber"}, kDenoised));
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.errors, HasSubstr("p.noisy.exr"));
  EXPECT_EQ(Bytes("p.noisy.exr"), "kept");
  EXPECT_FALSE(Exists("p.exr"));
}

}  // namespace
}  // namespace tessera
