// Pictures with mattes: the same bytes from every farm, whatever fails.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/build_paths.h"
#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class MattePictures : public EndToEnd {
 protected:
  // Decodes mattes by a script that knows the specification alone.
  Outcome Decode(const std::string& words) const {
    return RunShell(folder(), "python3 -B " + SourceDir() + "/tests/picture/cryptomatte.py " + words);
  }
  // A worker and the coordinator are killed while the box is rendered with these options.
  void ExpectSurvival(const std::vector<std::string>& options) {
    const std::string oracle = Oracle(BoxScene(), options);
    StartCoordinator();
    Process& doomed = StartWorker("doomed");
    StartWorker("steady");
    const std::string job = Submit(BoxScene(), options);
    AwaitShare(job, 0.05);
    doomed.Signal(SIGKILL);
    coordinator().Signal(SIGKILL);
    EXPECT_EQ(coordinator().Wait(), -SIGKILL);
    StartCoordinator();
    ASSERT_EQ(Ask({"watch", job}).code, 0);
    ASSERT_EQ(Ask({"fetch", job, "-o", "picture.exr"}).code, 0);
    EXPECT_TRUE(Bytes("picture.exr") == oracle);
    EXPECT_EQ(Decode("picture.exr").code, 0);
  }
};

std::vector<std::string> Plus(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

const std::vector<std::string> kMattes{"--aov", "crypto_object,crypto_material,crypto_asset"};

TEST_F(MattePictures, AreTheSameForAnyNumberOfWorkersAndTiles) {
  const std::string oracle = Oracle(BoxScene(), kMattes);
  for (const auto& way :
       std::vector<std::vector<std::string>>{{"--in-process", "--threads", "3", "--tile-size", "7"},
                                             {"--workers", "1", "--threads", "1"},
                                             {"--workers", "5", "--tile-size", "16"}}) {
    const Outcome outcome = Tessera(Plus(Plus({"render", BoxScene(), "-o", "picture.exr"}, way), kMattes));
    ASSERT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_TRUE(Bytes("picture.exr") == oracle) << testing::PrintToString(way);
  }
  const Outcome decoded = Decode("picture.exr");
  EXPECT_EQ(decoded.code, 0) << decoded.errors;
  EXPECT_THAT(decoded.output, HasSubstr("\"sphere.3\""));
}

TEST_F(MattePictures, SurviveKilledWorkersAndCoordinator) {
  ExpectSurvival(Plus(kMattes, {"--spp", "256"}));
}

TEST_F(MattePictures, OfAnAdaptiveFrameSurviveKilledWorkersAndCoordinator) {
  ExpectSurvival(Plus(kMattes, {"--spp", "300", "--noise-threshold", "0.05"}));
}

TEST_F(MattePictures, OfAnAnimatedSceneAreTheSameOnEveryFarmAndKeepTheirNames) {
  const std::string scene =
      Write("walk.pbrt",
            "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16\n"
            "Sampler \"zsobol\" \"integer pixelsamples\" 4\nCamera \"perspective\"\nWorldBegin\n"
            "LightSource \"infinite\" Shape \"disk\" Translate 0 0 5\n"
            "ActiveTransform EndTime Translate 1 0 0 ActiveTransform All Shape \"sphere\" Shape \"disk\"\n");
  const std::vector<std::string> frames{"--frames", "0-24x24"};
  ASSERT_EQ(Tessera(Plus(Plus({"render", scene, "--in-process", "-o", "here.exr"}, frames), kMattes)).code,
            0);
  ASSERT_EQ(Tessera(Plus(Plus({"render", scene, "--workers", "2", "-o", "farm.exr"}, frames), kMattes)).code,
            0);
  EXPECT_TRUE(Bytes("here.0000.exr") == Bytes("farm.0000.exr"));
  EXPECT_TRUE(Bytes("here.0024.exr") == Bytes("farm.0024.exr"));
  EXPECT_FALSE(Bytes("here.0000.exr") == Bytes("here.0024.exr"));
  const Outcome first = Decode("farm.0000.exr"), last = Decode("farm.0024.exr");
  EXPECT_THAT(first.output, HasSubstr("[\"disk.1\", \"sphere.1\", \"disk.2\"]")) << first.errors;
  EXPECT_EQ(last.output, first.output);
}

}  // namespace
}  // namespace tessera
