// Pictures with mattes: the same bytes from every farm, whatever fails.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

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
  // The mattes of the box survive what kills a worker and the coordinator.
  void ExpectMattesSurvive(const std::vector<std::string>& options) {
    ExpectSurvival(options);
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

TEST_F(MattePictures, OfAnyNumberOfLevelsAreTheSameOnEveryFarm) {
  for (const std::string levels : {"1", "8"}) {
    const std::vector<std::string> options = Plus(kMattes, {"--cryptomatte-levels", levels});
    const std::string oracle = Oracle(BoxScene(), options);
    const Outcome outcome = Tessera(
        Plus({"render", BoxScene(), "-o", "picture.exr", "--workers", "3", "--tile-size", "16"}, options));
    ASSERT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_TRUE(Bytes("picture.exr") == oracle) << levels;
    const Outcome decoded = Decode("picture.exr");
    EXPECT_EQ(decoded.code, 0) << decoded.errors;
    const std::string info = Tessera({"info", "picture.exr", "--json"}).output;
    EXPECT_THAT(info, HasSubstr("CryptoObject00.A"));
    EXPECT_EQ(info.find("CryptoObject01.A") != std::string::npos, levels == "8") << info;
    EXPECT_EQ(info.find("CryptoObject07.A") != std::string::npos, levels == "8") << info;
    EXPECT_THAT(info, testing::Not(HasSubstr("CryptoObject08")));
  }
}

// The frame has them, not the coordinator: what renders it later does not choose again.
TEST_F(MattePictures, OfAJobKeepTheirLevelsWhenTheCoordinatorRestartsAndTheJobIsExtended) {
  const std::string scene = Write("extendable.pbrt",
                                  "Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" 24\n"
                                  "Sampler \"independent\" \"integer pixelsamples\" 4\n"
                                  "Camera \"perspective\" WorldBegin LightSource \"infinite\"\n"
                                  "Translate 0 0 4 Shape \"sphere\" Shape \"disk\" \"float radius\" 2\n");
  const std::vector<std::string> options = Plus(kMattes, {"--cryptomatte-levels", "5"});
  StartCoordinator();
  StartWorker("first");
  const std::string job = Submit(scene, options);
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  coordinator().Signal(SIGKILL);
  ASSERT_EQ(coordinator().Wait(), -SIGKILL);
  StartCoordinator();
  ASSERT_EQ(Ask({"extend", job, "--spp", "16"}).code, 0);
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  ASSERT_EQ(Ask({"fetch", job, "-o", "extended.exr"}).code, 0);
  EXPECT_TRUE(Bytes("extended.exr") == Oracle(scene, Plus(options, {"--spp", "16"})));
}

TEST_F(MattePictures, SurviveKilledWorkersAndCoordinator) {
  ExpectMattesSurvive(Plus(kMattes, {"--spp", "256"}));
}

TEST_F(MattePictures, OfAnAdaptiveFrameSurviveKilledWorkersAndCoordinator) {
  ExpectMattesSurvive(Plus(kMattes, {"--spp", "300", "--noise-threshold", "0.05"}));
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

TEST_F(MattePictures, InfoDescribesAPictureAndRefusesADamagedOne) {
  ASSERT_EQ(Tessera(Plus({"render", BoxScene(), "--in-process", "-o", "a.exr", "--compression", "piz",
                          "--exr-layout", "tiles"},
                         kMattes))
                .code,
            0);
  const Outcome json = Tessera({"info", "a.exr", "--json"});
  for (const char* each : {R"("compression":"piz")", R"("layout":"tiles")", R"("layer":"CryptoAsset")",
                           R"({"name":"CryptoAsset00.R","type":"float"})", R"("value":"MurmurHash3_32")"})
    EXPECT_THAT(json.output, HasSubstr(each)) << json.errors;
  const Outcome text = Tessera({"info", "a.exr"});
  EXPECT_THAT(text.output, HasSubstr("compression piz\n"));
  EXPECT_THAT(text.output, HasSubstr("colours: B G R (half)\n"));
  Write("torn.exr", Bytes("a.exr").substr(0, 700));
  const Outcome torn = Tessera({"info", "torn.exr"});
  EXPECT_EQ(torn.code, 2);
  EXPECT_THAT(torn.errors, HasSubstr("torn.exr"));
}

TEST_F(MattePictures, AreTheSameInEveryCompressionThatLosesNothing) {
  ASSERT_EQ(Tessera(Plus({"render", BoxScene(), "--in-process", "-o", "zip.exr"}, kMattes)).code, 0);
  const std::string copper = " --matte CryptoObject sphere.1";
  const Outcome matte = Decode("zip.exr" + copper);
  EXPECT_GT(std::stod("0" + matte.output), 0.01) << matte.errors;
  for (const std::string compression : {"none", "rle", "zips", "piz"}) {
    const Outcome outcome = Tessera(Plus({"render", BoxScene(), "--workers", "2", "-o", "tiles.exr",
                                          "--exr-layout", "tiles", "--compression", compression},
                                         kMattes));
    ASSERT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_THAT(Tessera({"compare", "tiles.exr", "zip.exr"}).output, HasSubstr("identical=yes"));
    if (compression != "piz") {
      EXPECT_EQ(Decode("tiles.exr" + copper).output, matte.output) << compression;
    }
  }
}

TEST_F(MattePictures, ACompressionThatWouldChangeThemIsRefusedUnlessTheyHaveFilesOfTheirOwn) {
  const std::vector<std::string> lossy = Plus(kMattes, {"--compression", "dwaa"});
  const Outcome refused = Tessera(Plus({"render", BoxScene(), "--in-process", "-o", "p.exr"}, lossy));
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.errors, HasSubstr("would change channel"));
  EXPECT_FALSE(Exists("p.exr"));
  ASSERT_EQ(Tessera(Plus({"render", BoxScene(), "--in-process", "--aov-split", "-o", "p.exr"}, lossy)).code,
            0);
  EXPECT_THAT(Tessera({"info", "p.exr"}).output, HasSubstr("compression dwaa"));
  EXPECT_THAT(Tessera({"info", "p.CryptoObject.exr"}).output, HasSubstr("compression zip"));
  for (const std::string layer : {"CryptoObject", "CryptoMaterial", "CryptoAsset"}) {
    const Outcome decoded = Decode("p." + layer + ".exr");
    EXPECT_EQ(decoded.code, 0) << decoded.errors;
    EXPECT_THAT(decoded.output, testing::StartsWith(layer));
  }
}

TEST_F(MattePictures, LayersFetchedFromAFarmAreTheFilesOfOneProcess) {
  StartCoordinator();
  StartWorker("only");
  const std::vector<std::string> options = Plus(kMattes, {"--cryptomatte-levels", "4"});
  const std::string job = Submit(BoxScene(), options);
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  ASSERT_EQ(Ask({"fetch", job, "-o", "farm.exr", "--aov-split"}).code, 0);
  ASSERT_EQ(
      Tessera(Plus({"render", BoxScene(), "--in-process", "--aov-split", "-o", "here.exr"}, options)).code,
      0);
  EXPECT_EQ(Decode("here.CryptoObject.exr").code, 0);
  for (const std::string ending : {".exr", ".CryptoObject.exr", ".CryptoMaterial.exr", ".CryptoAsset.exr"})
    EXPECT_TRUE(Bytes("farm" + ending) == Bytes("here" + ending)) << ending;
  EXPECT_EQ(Ask({"fetch", job, "-o", "-", "--aov-split"}).code, 2);
  EXPECT_EQ(Ask({"fetch", job, "-o", "a.png", "--aov-split"}).code, 2);
  EXPECT_EQ(Ask({"fetch", job, "-o", "a.exr", "--compression", "dwaa"}).code, 2);
}

TEST_F(MattePictures, AFileOfALayerNeverReplacesAFileOfTheScene) {
  ASSERT_EQ(Tessera({"render", BoxScene(), "--in-process", "--spp", "1", "--resolution", "8x8", "-o",
                     "p.samples.exr"})
                .code,
            0);
  const std::string before = Bytes("p.samples.exr");
  const std::string scene =
      Write("scene.pbrt", "WorldBegin LightSource \"infinite\" \"string filename\" \"p.samples.exr\"\n");
  const Outcome outcome = Tessera({"render", scene, "--in-process", "--spp", "1", "--resolution", "8x8", "-o",
                                   "p.exr", "--aov", "samples", "--aov-split"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("p.samples.exr: the command reads this file"));
  EXPECT_TRUE(Bytes("p.samples.exr") == before);
}

}  // namespace
}  // namespace tessera
