// Control of running jobs and workers: pause, priority, tags, verification, drain.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/end_to_end/farm_fixture.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using Controls = EndToEnd;

TEST_F(Controls, APausedJobStaysPausedAfterARestartAndItsPictureIsTheSame) {
  StartCoordinator();
  StartWorker("only");
  const std::vector<std::string> options{"--spp", "256"};
  const std::string job = Submit(BoxScene(), options);
  const Outcome paused = Ask({"pause", job, "--json"});
  EXPECT_EQ(paused.code, 0) << paused.errors;
  EXPECT_THAT(paused.output, HasSubstr("\"state\":\"paused\",\"reason\":\"by the user\""));
  EXPECT_TRUE(Eventually([&] { return Figure(job, "workers") == 0; })) << "running units are finished";
  const double done = Figure(job, "samples_done");
  StartCoordinator();
  EXPECT_TRUE(Eventually([&] { return Ask({"workers"}).output.find("only") != std::string::npos; }));
  EXPECT_THAT(Ask({"status", job}).output, HasSubstr("paused"));
  EXPECT_LE(Figure(job, "samples_done"), done);
  EXPECT_EQ(Figure(job, "workers"), 0);
  EXPECT_EQ(Ask({"resume", job}).code, 0);
  EXPECT_EQ(Ask({"watch", job}).code, 0);
  ASSERT_EQ(Ask({"fetch", job, "-o", "picture.exr"}).code, 0);
  EXPECT_TRUE(Bytes("picture.exr") == Oracle(BoxScene(), options));
  const Outcome late = Ask({"pause", job});
  EXPECT_EQ(late.code, 2);
  EXPECT_THAT(late.errors, HasSubstr("it can no longer be paused"));
}

TEST_F(Controls, ARegionThatGoesFirstLeavesThePictureAsItIs) {
  StartCoordinator();
  const std::vector<std::string> options{"--spp", "64"};
  const std::string oracle = Oracle(BoxScene(), options);
  const std::string job = Submit(BoxScene(), {"--spp", "64", "--first", "0.5,1,0,0.5"});
  StartCoordinator();  // it is in the journal
  StartWorker("only");
  EXPECT_EQ(Ask({"watch", job}).code, 0);
  ASSERT_EQ(Ask({"fetch", job, "-o", "farm.exr"}).code, 0);
  EXPECT_TRUE(Bytes("farm.exr") == oracle);
  const Outcome here = Tessera(
      {"render", BoxScene(), "--spp", "64", "--first", "0.9,1,0.9,1", "--in-process", "-o", "here.exr"});
  EXPECT_EQ(here.code, 0) << here.errors;
  EXPECT_TRUE(Bytes("here.exr") == oracle);
  const Outcome cropped = Tessera({"render", BoxScene(), "--crop", "0,0.5,0,1", "--first", "0.6,1,0,1"});
  EXPECT_EQ(cropped.code, 2);
  EXPECT_THAT(cropped.errors, HasSubstr("--first: nothing of that part is rendered"));
}

TEST_F(Controls, APriorityIsChangedWhileTheJobRuns) {
  StartCoordinator();
  const std::string job = Submit(BoxScene(), {"--priority", "5"});
  const Outcome changed = Ask({"priority", job, "-7", "--json"});
  EXPECT_EQ(changed.code, 0) << changed.errors;
  EXPECT_THAT(changed.output, HasSubstr("\"priority\":-7"));
  StartCoordinator();
  EXPECT_EQ(Figure(job, "priority"), -7);
}

TEST_F(Controls, AJobThatRequiresATagWaitsForAWorkerThatHasIt) {
  StartCoordinator();
  StartWorker("plain");
  const std::string job = Submit(BoxScene(), {"--require", "gpu"});
  EXPECT_THAT(Ask({"status", job}).output, HasSubstr("waiting"));
  EXPECT_THAT(Ask({"jobs"}).output, HasSubstr("no worker has tag gpu"));
  StartWorker("special", 1, {"--tag", "gpu", "--tag", "big"});
  EXPECT_EQ(Ask({"watch", job}).code, 0);
  const std::string workers = Ask({"workers"}).output;
  EXPECT_THAT(workers, HasSubstr("[big gpu]"));
  EXPECT_THAT(Ask({"workers", "--json"}).output, HasSubstr("\"units_finished\":0")) << "the plain one";
}

TEST_F(Controls, AVerifiedPictureHasTheSameBitsAndCountsWhatWasCompared) {
  StartCoordinator();
  StartWorker("one");
  const std::string job = Submit(BoxScene(), {"--verify", "100%"});
  EXPECT_TRUE(Eventually([&] {
    return Ask({"status", job}).output.find("to be verified by another worker") != std::string::npos;
  }));
  StartWorker("two");
  EXPECT_EQ(Ask({"watch", job}).code, 0);
  EXPECT_GT(Figure(job, "units_verified"), 0);
  EXPECT_EQ(Figure(job, "units_disputed"), 0);
  ASSERT_EQ(Ask({"fetch", job, "-o", "picture.exr"}).code, 0);
  EXPECT_TRUE(Bytes("picture.exr") == Oracle(BoxScene(), {}));
}

TEST_F(Controls, ALocalFarmVerifiesWithTwoProcesses) {
  const Outcome rendered = Tessera({"render", BoxScene(), "--verify", "50%", "-o", "picture.exr"});
  EXPECT_EQ(rendered.code, 0) << rendered.errors;
  EXPECT_TRUE(Bytes("picture.exr") == Oracle(BoxScene(), {}));
  for (const char* alone : {"--workers=1", "--in-process"}) {
    const Outcome refused = Tessera({"render", BoxScene(), "--verify", "50%", alone});
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.errors, HasSubstr("at least two workers"));
  }
}

TEST_F(Controls, ADrainedWorkerGetsNoWorkUntilItIsReleased) {
  StartCoordinator();
  StartWorker("tired");
  EXPECT_TRUE(Eventually([&] { return Ask({"drain", "tired"}).code == 0; }));
  const std::string job = Submit(BoxScene(), {});
  EXPECT_THAT(Ask({"workers"}).output, HasSubstr("drained"));
  EXPECT_EQ(Figure(job, "workers"), 0);
  EXPECT_THAT(Ask({"status", job}).output, HasSubstr("no worker accepts work: 1 drained"));
  EXPECT_EQ(Ask({"release", "tired"}).code, 0);
  EXPECT_EQ(Ask({"watch", job}).code, 0);
  const Outcome nobody = Ask({"drain", "nobody"});
  EXPECT_EQ(nobody.code, 2);
  EXPECT_THAT(nobody.errors, HasSubstr("there is no worker \"nobody\""));
}

TEST_F(Controls, ADrainOutlivesRestartsOfTheWorkerAndOfTheCoordinator) {
  StartCoordinator();
  Process& before = StartWorker("tired");
  EXPECT_TRUE(Eventually([&] { return Ask({"drain", "tired"}).code == 0; }));
  before.Signal(SIGKILL);
  before.Wait();
  EXPECT_TRUE(Eventually([&] { return Ask({"workers"}).output.find("tired") == std::string::npos; }));
  coordinator().Signal(SIGKILL);
  coordinator().Wait();
  StartCoordinator();
  StartWorker("tired");
  EXPECT_TRUE(Eventually([&] { return Ask({"workers"}).output.find("drained") != std::string::npos; }));
  const std::string job = Submit(BoxScene(), {});
  EXPECT_THAT(Ask({"status", job}).output, HasSubstr("no worker accepts work: 1 drained"));
  EXPECT_EQ(Ask({"release", "tired"}).code, 0);
  EXPECT_EQ(Ask({"watch", job}).code, 0);
}

}  // namespace
}  // namespace tessera
