// Acknowledged results are neither lost nor rendered again, and finished jobs can be extended.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "tests/end_to_end/farm_fixture.h"
#include "tests/small_disk.h"

namespace tessera {
namespace {

using testing::HasSubstr;

class Durability : public EndToEnd {
 protected:
  // A textured scene whose samples do not depend on the number of samples.
  std::string ExtendableScene() const {
    return Write("extendable.pbrt",
                 "Sampler \"paddedsobol\"\n"
                 "Film \"rgb\" \"integer xresolution\" 96 \"integer yresolution\" 64\n"
                 "LookAt 0 1 -4 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 40\nWorldBegin\n"
                 "LightSource \"infinite\"\n"
                 "Texture \"c\" \"spectrum\" \"checkerboard\" \"float uscale\" 9 \"float vscale\" 7\n"
                 "Material \"diffuse\" \"texture reflectance\" \"c\"\nShape \"sphere\"\n");
  }
  // The sum of all numbers that follow `key` in the coordinator's log.
  double Logged(const std::string& key) {
    const std::string log = coordinator().Errors();
    double sum = 0;
    for (size_t at = log.find(key); at != std::string::npos; at = log.find(key, at + 1)) {
      sum += std::stod(log.substr(at + key.size()));
    }
    return sum;
  }
  // Kills the coordinator and starts it again with the same data.
  void RestartCoordinator() {
    coordinator().Signal(SIGKILL);
    EXPECT_EQ(coordinator().Wait(), -SIGKILL);
    StartCoordinator();
    EXPECT_TRUE(coordinator().AwaitErrors("samples_restored="));
  }
  std::string Fetched(const std::string& job) {
    const Outcome outcome = Ask({"fetch", job, "-o", "picture.exr"});
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    return Bytes("picture.exr");
  }
};

TEST_F(Durability, NothingAcknowledgedIsRenderedAgainAfterKills) {
  const std::string oracle = Oracle(BoxScene(), kLongRender);
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit(BoxScene(), kLongRender);
  const double total = Figure(job, "samples_total");
  for (const double share : {0.05, 0.15, 0.25}) {
    AwaitShare(job, share);
    RestartCoordinator();
    EXPECT_GT(Logged("samples_restored="), share * total / 2) << "from the previous process";
  }
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  EXPECT_EQ(Logged("samples_restored=") + Logged("samples_accepted="), total);
  EXPECT_TRUE(Fetched(job) == oracle);
}

TEST_F(Durability, AnExtendedPictureEqualsOneRenderedWithAllSamples) {
  const std::string scene = ExtendableScene();
  const std::string oracle = Oracle(scene, {"--spp", "75"});
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit(scene, {"--spp", "12"});
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  const Outcome extended = Ask({"extend", job, "--spp", "75"});
  ASSERT_EQ(extended.code, 0) << extended.errors;
  RestartCoordinator();
  EXPECT_GE(Logged("samples_restored="), 96 * 64 * 12);
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  EXPECT_EQ(Logged("samples_restored=") + Logged("samples_accepted="), 96 * 64 * 75)
      << "nothing is rendered twice";
  EXPECT_TRUE(Fetched(job) == oracle);
}

TEST_F(Durability, ARunningJobIsExtendedWithoutLoadingItsSceneAgain) {
  const std::string scene = ExtendableScene();
  const std::string oracle = Oracle(scene, {"--spp", "2048"});
  StartCoordinator();
  Process& worker = StartWorker("only");
  const std::string job = Submit(scene, {"--spp", "1024"});
  AwaitShare(job, 0.02);
  ASSERT_EQ(Ask({"extend", job, "--spp", "2048"}).code, 0);
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  EXPECT_TRUE(Fetched(job) == oracle);
  const std::string log = worker.Errors();
  ASSERT_NE(log.find("scene_loaded "), std::string::npos) << log;
  EXPECT_EQ(log.find("scene_loaded "), log.rfind("scene_loaded ")) << "loaded once";
}

TEST_F(Durability, ExtendRefusesASamplerThatDependsOnTheNumberOfSamples) {
  StartCoordinator();
  const std::string scene = Write("fixed.pbrt",
                                  "Sampler \"zsobol\"\nCamera \"perspective\"\nWorldBegin\n"
                                  "LightSource \"infinite\"\nShape \"sphere\"\n");
  const Outcome outcome = Ask({"extend", Submit(scene, {}), "--spp", "64"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.errors, testing::AllOf(HasSubstr("\"zsobol\""), HasSubstr("--spp 64")));
}

TEST_F(Durability, AFullDiskPausesTheJobUntilSpaceIsFree) {
  const SmallDisk disk(Path("data"));
  if (!disk.is_mounted()) GTEST_SKIP() << "no permission to mount a file system";
  const std::string oracle = Oracle(BoxScene(), kLongRender);
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit(BoxScene(), kLongRender);
  AwaitShare(job, 0.05);
  disk.Fill();
  ASSERT_TRUE(Eventually([&] {
    const std::string status = Ask({"status", job}).output;
    return status.find("paused") != std::string::npos && status.find("No space left") != std::string::npos;
  }));
  EXPECT_THAT(Ask({"jobs"}).output, HasSubstr("No space left"));
  disk.Free();
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  EXPECT_TRUE(Fetched(job) == oracle);
}

TEST_F(Durability, ASubmitOnAFullDiskNamesItAndNothingAppearsLater) {
  const SmallDisk disk(Path("data"));
  if (!disk.is_mounted()) GTEST_SKIP() << "no permission to mount a file system";
  StartCoordinator();
  Submit(BoxScene(), {"--spp", "4"});  // its files are there now
  disk.Fill();
  const auto start = std::chrono::steady_clock::now();
  const Outcome refused = Ask({"submit", BoxScene(), "--spp", "8"});
  EXPECT_LT(std::chrono::steady_clock::now() - start, kSlowdown * std::chrono::seconds(20));
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.errors, testing::AllOf(HasSubstr(Path("data")), HasSubstr("file system")));
  disk.Free();
  const Outcome next = Ask({"submit", BoxScene(), "--spp", "16"});
  EXPECT_EQ(next.code, 0) << next.errors;
  EXPECT_EQ(next.output, "2\n") << "the refused job is not there";
}

TEST_F(Durability, ControlsOnAFullDiskNameItAndEverythingContinuesWhenThereIsSpace) {
  const SmallDisk disk(Path("data"));
  if (!disk.is_mounted()) GTEST_SKIP() << "no permission to mount a file system";
  const std::string scene = ExtendableScene();
  const std::string oracle = Oracle(scene, {"--spp", "1500"});
  StartCoordinator();
  StartWorker("only");
  const std::string job = Submit(scene, {"--spp", "1500"});
  ASSERT_EQ(Ask({"priority", job, "3"}).code, 0);
  disk.Fill();
  const std::vector<std::vector<std::string>> controls{
      {"pause", job},    {"resume", job},    {"priority", job, "5"}, {"extend", job, "--spp", "3000"},
      {"drain", "only"}, {"release", "only"}};
  for (const std::vector<std::string>& control : controls) {
    const auto start = std::chrono::steady_clock::now();
    const Outcome refused = Ask(control);
    EXPECT_LT(std::chrono::steady_clock::now() - start, kSlowdown * std::chrono::seconds(20))
        << control.front();
    EXPECT_EQ(refused.code, 1) << control.front();
    EXPECT_THAT(refused.errors, testing::AllOf(HasSubstr(Path("data")), HasSubstr("No space left")))
        << control.front();
  }
  disk.Free();
  RestartCoordinator();
  EXPECT_EQ(Figure(job, "priority"), 3) << "what was acknowledged holds, what was refused was not done";
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  EXPECT_TRUE(Fetched(job) == oracle);
}

TEST_F(Durability, AJobCancelledOnAFullDiskMakesRoomForOthers) {
  const SmallDisk disk(Path("data"));
  if (!disk.is_mounted()) GTEST_SKIP() << "no permission to mount a file system";
  const std::string oracle = Oracle(BoxScene(), {"--spp", "16"});
  StartCoordinator();
  StartWorker("only");
  // Its sums and picture take several times the space of the small job's.
  std::vector<std::string> options = kLongRender;
  options.insert(options.end(), {"--resolution", "384x288"});
  const std::string large = Submit(BoxScene(), options);
  AwaitShare(large, 0.02);
  const std::string small = Submit(BoxScene(), {"--spp", "16"});
  disk.Fill();
  ASSERT_TRUE(Eventually([&] { return Ask({"jobs"}).output.find("No space left") != std::string::npos; }));
  const Outcome cancelled = Ask({"cancel", large});
  EXPECT_EQ(cancelled.code, 0) << cancelled.errors;
  EXPECT_THAT(Ask({"status", large}).output, HasSubstr("cancelled"));
  ASSERT_EQ(Ask({"watch", small}).code, 0) << "in the space of the cancelled job";
  EXPECT_TRUE(Fetched(small) == oracle);
  coordinator().Signal(SIGKILL);
  EXPECT_EQ(coordinator().Wait(), -SIGKILL);
  StartCoordinator();
  EXPECT_THAT(Ask({"status", large}).output, HasSubstr("cancelled"));
}

TEST_F(Durability, StoredFilesFoundDamagedAreSentAgainByTheSubmissionThatNeedsThem) {
  StartCoordinator();
  Submit(BoxScene(), {"--spp", "1"});
  coordinator().Signal(SIGTERM);
  coordinator().Wait();
  for (const auto& entry : std::filesystem::recursive_directory_iterator(Path("data/blobs"))) {
    if (!entry.is_regular_file()) continue;
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    const int first = file.get();
    file.seekp(0);
    file.put(static_cast<char>(first ^ 1));
  }
  StartCoordinator();
  const std::string job = Submit(BoxScene(), {"--spp", "4"});
  StartWorker("only");
  ASSERT_EQ(Ask({"watch", job}).code, 0);
  ASSERT_EQ(Ask({"fetch", job, "-o", "out.exr"}).code, 0);
  EXPECT_TRUE(Bytes("out.exr") == Oracle(BoxScene(), {"--spp", "4"}));
}

TEST_F(Durability, AMissingJournalIsRefusedUnlessTheUserStartsAfresh) {
  StartCoordinator();
  Submit(BoxScene(), {"--spp", "4"});
  coordinator().Signal(SIGKILL);
  EXPECT_EQ(coordinator().Wait(), -SIGKILL);
  std::filesystem::remove(Path("data/journal"));
  const std::vector<std::string> words{"--listen", "unix:" + Path("other"), "--data-dir", Path("data")};
  const Outcome refused = RunProgram(Path(""), "tessera-coordinator", words);
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.errors,
              testing::AllOf(HasSubstr("its journal is missing"), HasSubstr("--start-afresh")));
}

}  // namespace
}  // namespace tessera
