// A data directory that an earlier release left is continued: every job, result and sum in it is there, and
// nothing that was acknowledged is rendered again. Its samples have the noise of that release, so a frame
// that is continued has the mean of a frame of this one, but not its bits.
//
// tests/coordinator/store/data/format-4 was left by release 0.1 ("tessera-data 4"), whose coordinator and
// worker were killed. All three jobs are of the scene in it, with tiles of 8 pixels:
//   1  finished: --spp 13 --aov samples
//   2  paused in mid-frame: --spp 5000 --exr-type float
//   3  paused in mid-frame: --spp 8192 --noise-threshold 0.008 --aov samples
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "renderer/util/digest.h"
#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

// The picture of job 1, which that release wrote.
constexpr const char* kFirstPicture = "cfbcbffd84d4ed62382583fb5bad97998fb3ea91dd19a7e06e50ebc07a395fe3";

// Of frames of at least 5,000 samples, and of 40.
constexpr double kNoise = 0.0001;
constexpr double kNoiseOfFewSamples = 0.002;

class Migration : public EndToEnd {
 protected:
  Migration() { RestoreDirectory(); }
  // As that release left it.
  void RestoreDirectory() {
    std::filesystem::remove_all(Path("data"));
    std::filesystem::copy(SourceDir() + "/tests/coordinator/store/data/format-4", Path("data"),
                          std::filesystem::copy_options::recursive);
  }
  // The picture that this release renders of the scene in one go.
  std::string OracleOf(const std::vector<std::string>& arguments) {
    const std::string blob = "a8/a8311a9b3a22f09077f1b96bd962d456a84d8f601bd1b9053e6a730c313ebe74";
    const std::string scene = Write("corner.pbrt", Bytes("data/blobs/" + blob));
    std::vector<std::string> words{"--tile-size", "8"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return Oracle(scene, words);
  }
  // The error of the picture of the job against that picture.
  double ErrorOf(const std::string& job, const std::vector<std::string>& arguments) {
    std::ofstream(Path("expected.exr"), std::ios::binary) << OracleOf(arguments);
    DigestOf(job);
    const Outcome compared = Tessera({"compare", "picture.exr", "expected.exr", "--layer", "RGB", "--json"});
    EXPECT_EQ(compared.code, 1) << "pictures with other noise differ: " << compared.errors;
    return nlohmann::json::parse(compared.output).at("relmse");
  }
  std::string DigestOf(const std::string& job) {
    const Outcome outcome = Ask({"fetch", job, "-o", "picture.exr"});
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    return Sha256(Bytes("picture.exr")).Hex();
  }
  // Each number that follows `key` in the coordinator's log, added.
  double Logged(const std::string& key) {
    const std::string log = coordinator().Errors();
    double sum = 0;
    for (size_t at = log.find(key); at != std::string::npos; at = log.find(key, at + 1))
      sum += std::stod(log.substr(at + key.size()));
    return sum;
  }
};

TEST_F(Migration, ADirectoryOfFormat4IsContinuedWithoutRenderingAgain) {
  StartCoordinator();
  ASSERT_TRUE(coordinator().AwaitErrors("samples_restored="));
  EXPECT_EQ(Bytes("data/version"), "tessera-data 6\n");
  EXPECT_EQ(Figure("2", "samples_done"), 212992);
  EXPECT_EQ(Figure("3", "samples_done"), 106496);
  EXPECT_EQ(DigestOf("1"), kFirstPicture);
  StartWorker("only");
  for (const char* job : {"2", "3"}) {
    ASSERT_EQ(Ask({"resume", job}).code, 0);
    ASSERT_EQ(Ask({"watch", job}).code, 0);
  }
  EXPECT_EQ(Logged("samples_restored="), 212992 + 106496);
  EXPECT_EQ(Logged("samples_restored=") + Logged("samples_accepted="),
            Figure("2", "samples_total") + Figure("3", "samples_total"))
      << "nothing acknowledged is rendered again";
  EXPECT_LT(ErrorOf("2", {"--spp", "5000", "--exr-type", "float"}), kNoise);
  EXPECT_LT(ErrorOf("3", {"--spp", "8192", "--noise-threshold", "0.008", "--aov", "samples"}), kNoise);
}

TEST_F(Migration, AFinishedJobOfFormat4IsExtendedByWhatItLacks) {
  StartCoordinator();
  StartWorker("only");
  const Outcome extended = Ask({"extend", "1", "--spp", "40"});
  ASSERT_EQ(extended.code, 0) << extended.errors;
  ASSERT_EQ(Ask({"watch", "1"}).code, 0);
  EXPECT_EQ(Logged("samples_accepted="), 16 * 16 * (40 - 13));
  EXPECT_LT(ErrorOf("1", {"--spp", "40", "--aov", "samples"}), kNoiseOfFewSamples);
}

// Its files name no scene. They count only in the directory that they were in when it was upgraded.
TEST_F(Migration, ASpoolOfFormat4ThatComesIntoAnUpgradedDirectoryIsNotBelieved) {
  StartCoordinator();
  ASSERT_TRUE(coordinator().AwaitErrors("samples_restored="));
  coordinator().Signal(SIGKILL);
  coordinator().Wait();
  const std::string old = SourceDir() + "/tests/coordinator/store/data/format-4/spool";
  std::filesystem::remove_all(Path("data/spool/2-0"));
  std::filesystem::copy(old + "/2-0", Path("data/spool/2-0"));
  StartCoordinator();
  ASSERT_TRUE(coordinator().AwaitErrors("spool_file_ignored"));
  EXPECT_EQ(Figure("2", "samples_done"), 0);
  EXPECT_EQ(Figure("3", "samples_done"), 106496) << "the spool of the directory itself";
  StartWorker("only");
  ASSERT_EQ(Ask({"resume", "2"}).code, 0);
  ASSERT_EQ(Ask({"watch", "2"}).code, 0);
  std::ofstream(Path("expected.exr"), std::ios::binary) << OracleOf({"--spp", "5000", "--exr-type", "float"});
  DigestOf("2");
  EXPECT_EQ(Tessera({"compare", "picture.exr", "expected.exr"}).code, 0)
      << "the bits of this release, with the header of the earlier one";
}

// What a restart finds is a mixture of old files and new ones.
TEST_F(Migration, AMigratedDirectoryIsOpenedAgain) {
  StartCoordinator();
  StartWorker("undisturbed");
  ASSERT_EQ(Ask({"resume", "2"}).code, 0);
  ASSERT_EQ(Ask({"watch", "2"}).code, 0);
  const std::string undisturbed = DigestOf("2");
  coordinator().Signal(SIGKILL);
  coordinator().Wait();
  RestoreDirectory();
  for (int start = 0; start < 2; ++start) {
    StartCoordinator();
    ASSERT_TRUE(coordinator().AwaitErrors("samples_restored="));
    StartWorker("worker-" + std::to_string(start));
    if (start == 0) {
      ASSERT_EQ(Ask({"resume", "2"}).code, 0);
      AwaitShare("2", 0.3);
      coordinator().Signal(SIGKILL);
      coordinator().Wait();
    }
  }
  ASSERT_EQ(Ask({"watch", "2"}).code, 0);
  EXPECT_EQ(DigestOf("2"), undisturbed);
}

}  // namespace
}  // namespace tessera
