// Workers that fail, units that cannot be rendered.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/core/schedule/scheduler_stage.h"

namespace tessera {
namespace {

using std::chrono::seconds;
using testing::AllOf;
using testing::HasSubstr;

TEST(SchedulerFailure, AUnitThatThreeWorkersFailFailsItsJobWithTheirReasons) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(1);
  for (uint64_t w = 1; w <= 4; ++w) {
    stage.Join(w, 16);
    stage.Advance();
    const auto held = stage.Held(w);
    const auto poison =
        std::find_if(held.begin(), held.end(), [](const Lease& each) { return each.unit.tile == 5; });
    ASSERT_NE(poison, held.end());
    stage.Fail(w, *poison, "broken " + std::to_string(w));
    const auto failed = stage.scheduler.TakeFailedJobs();
    ASSERT_EQ(failed.size(), w == 3 ? 1u : 0u) << "after " << w << " failures";
    if (w < 3) continue;
    EXPECT_EQ(failed[0].job, job);
    EXPECT_THAT(failed[0].reason,
                AllOf(HasSubstr("w1: broken 1"), HasSubstr("w2: broken 2"), HasSubstr("w3: broken 3")));
    break;
  }
}

TEST(SchedulerFailure, AFrameOfSeveralFailsAloneAndItsWorkersGetUnitsOfTheOthers) {
  SchedulerStage stage(SchedulerOptions{kLaterEpoch, 2});
  const JobId job = stage.AddJob(64, 0, 2);
  stage.Join(1, 4);
  stage.Join(2, 4);
  stage.Advance();
  const Lease lease = stage.Held(1)[0];
  ASSERT_EQ(lease.unit.frame, 0u);
  stage.Fail(1, lease, "broken");
  EXPECT_TRUE(stage.scheduler.TakeFailedFrames().empty());
  while (stage.scheduler.TakeFailedFrames().empty()) {
    const auto held = stage.Held(2);
    const auto poison = std::ranges::find_if(
        held, [&](const Lease& each) { return each.unit.tile == lease.unit.tile && each.unit.frame == 0; });
    if (poison != held.end()) {
      stage.Fail(2, *poison, "broken");
    } else {
      stage.FinishAll(2, 0.1);
      stage.Advance();
    }
    ASSERT_FALSE(stage.IsComplete(job, 0));
  }
  EXPECT_TRUE(stage.scheduler.TakeFailedJobs().empty());
  stage.scheduler.DropFrame(stage.jobs.at(job), 0);
  stage.Advance();
  for (const uint64_t w : {1, 2}) {
    ASSERT_FALSE(stage.Held(w).empty());
    for (const Lease& each : stage.Held(w)) EXPECT_EQ(each.unit.frame, 1u);
  }
}

TEST(SchedulerFailure, TheSameWorkerFailingAgainIsOneWorker) {
  SchedulerStage stage;
  stage.AddJob(1);
  stage.Join(1, 16);
  stage.Join(2, 16);
  stage.Advance();
  const Lease lease = stage.Held(1)[0];
  for (int i = 0; i < 5; ++i) stage.Fail(1, lease, "again");
  EXPECT_TRUE(stage.scheduler.TakeFailedJobs().empty());
}

TEST(SchedulerFailure, AWorkerNeverGetsBackAUnitItFailed) {
  SchedulerStage stage;
  stage.AddJob(8);
  stage.Join(1);
  stage.Advance();
  const Lease failed = stage.Held(1)[0];
  stage.Fail(1, failed, "no");
  for (int round = 0; round < 200; ++round) {
    stage.Advance();
    for (const Lease& lease : stage.Held(1)) EXPECT_NE(lease.unit.tile, failed.unit.tile);
    stage.FinishAll(1, 0.01);
  }
  EXPECT_FALSE(stage.IsComplete(JobId{1}, 0));
  stage.Join(2);
  stage.Advance();
  ASSERT_FALSE(stage.Held(2).empty());
  EXPECT_EQ(stage.Held(2)[0].unit.tile, failed.unit.tile);
}

TEST(SchedulerFailure, AWorkerThatFailedTheOnlyOpenUnitWorksForOtherJobs) {
  SchedulerStage stage;
  stage.AddJob(1, 5);
  const JobId other = stage.AddJob(64);
  stage.Join(1, 8);
  stage.Advance();
  const Lease failed = stage.Held(1)[0];
  stage.FinishAll(1, 0);
  stage.Fail(1, failed, "no");
  stage.Advance();
  for (const Lease& lease : stage.Held(1)) EXPECT_EQ(lease.unit.job, other);
  EXPECT_FALSE(stage.Held(1).empty());
}

TEST(SchedulerFailure, ASmallFarmMayFailEarlier) {
  SchedulerStage stage(SchedulerOptions{1, 1});
  stage.AddJob(1);
  stage.Join(1);
  stage.Advance();
  stage.Fail(1, stage.Held(1)[0], "no");
  EXPECT_EQ(stage.scheduler.TakeFailedJobs().size(), 1u);
}

TEST(SchedulerFailure, AUnitThatAllWorkersFailedFailsItsJobAfterTheGracePeriod) {
  SchedulerStage stage;
  stage.AddJob(1);
  stage.Join(1);
  stage.Advance();
  stage.Fail(1, stage.Held(1)[0], "no");
  Instant waited{};
  while (stage.scheduler.TakeFailedJobs().empty()) {
    stage.Send(1);
    stage.Advance(seconds(1));
    waited += seconds(1);
    ASSERT_LE(waited, kPoisonGrace + seconds(2));
  }
  EXPECT_GE(waited, kPoisonGrace - seconds(1));
}

TEST(SchedulerFailure, ASceneThatThreeWorkersCannotLoadFailsItsJob) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(1);
  for (uint64_t w = 1; w <= 3; ++w) {
    stage.Worker(w);
    stage.Send(w);
    stage.Advance();
    EXPECT_TRUE(stage.scheduler.TakeFailedJobs().empty());
    stage.scheduler.FailScene(WorkerId{w}, stage.SceneOf(job), "a.pbrt:3:1: no such file");
    stage.Send(w);
    stage.Advance();
    EXPECT_FALSE(stage.scheduler.HasNews(WorkerId{w})) << "it is not asked for the scene again";
  }
  const auto failed = stage.scheduler.TakeFailedJobs();
  ASSERT_EQ(failed.size(), 1u);
  EXPECT_THAT(failed[0].reason, HasSubstr("w2: a.pbrt:3:1: no such file"));
}

TEST(SchedulerFailure, WorkersThatFailedASceneOnceRenderItWhenTheOnlyOtherWorkerThatCouldLeaves) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64);
  stage.Join(3);
  for (const uint64_t w : {1, 2}) {
    stage.Worker(w);
    stage.Send(w);
    stage.Advance();
    stage.scheduler.FailScene(WorkerId{w}, stage.SceneOf(job), "the download timed out");
  }
  stage.Advance();
  ASSERT_FALSE(stage.Held(3).empty());
  stage.Finish(3, stage.Held(3)[0], 0.1);
  stage.scheduler.Disconnect(stage.now, WorkerId{3});
  stage.states.erase(3);
  stage.held.erase(3);
  for (const uint64_t w : {1, 2}) stage.Join(w);
  stage.Advance();
  EXPECT_FALSE(stage.Held(1).empty());
  EXPECT_FALSE(stage.Held(2).empty());
  EXPECT_EQ(stage.Status(1), "fine");
}

TEST(SchedulerFailure, OneFailureOfASceneCountsOnceHoweverManyJobsAreOfIt) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64);
  for (uint64_t again = 2; again <= 5; ++again) {
    auto spec = std::make_shared<JobSpec>(*stage.specs.at(job));
    spec->submission = again + 100;
    stage.Open(JobId{again + 100}, spec);
  }
  stage.Join(2, 64);
  stage.Worker(1);
  stage.Send(1);
  stage.Advance();
  stage.scheduler.FailScene(WorkerId{1}, stage.SceneOf(job), "the download timed out");
  for (int round = 0; round < 3; ++round) {
    stage.FinishAll(2, 0.01);
    stage.Advance();
  }
  EXPECT_EQ(stage.Status(1), "fine");
}

TEST(SchedulerFailure, AJobThatAllConnectedWorkersFailedShowsThatItNeedsAnother) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(1);
  stage.Join(1);
  stage.Advance();
  EXPECT_EQ(stage.scheduler.Obstacle(job), "");
  stage.Fail(1, stage.Held(1)[0], "no");
  EXPECT_THAT(stage.scheduler.Obstacle(job), AllOf(HasSubstr("another one is needed"), HasSubstr("w1: no")));
  stage.Join(2);
  EXPECT_EQ(stage.scheduler.Obstacle(job), "");
}

TEST(SchedulerFailure, FailuresByWorkersThatNeverHeldTheUnitAreIgnored) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(1);
  stage.Join(1, 16);
  stage.Advance();
  const Lease lease = stage.Held(1)[0];
  for (uint64_t w = 2; w <= 5; ++w) {
    stage.Worker(w);
    stage.Send(w);
    stage.scheduler.FailUnit(WorkerId{w}, lease.id, lease.unit, "made up");
    stage.scheduler.FailScene(WorkerId{w}, stage.SceneOf(job), "made up");
    stage.scheduler.RefuseResult(WorkerId{1}, LeaseId{}, lease.unit, "made up");
  }
  EXPECT_TRUE(stage.scheduler.TakeFailedJobs().empty());
  EXPECT_EQ(stage.Status(1), "fine") << "nobody can make it look bad";
}

TEST(SchedulerFailure, AWorkerThatFailsWhatOthersFinishIsQuarantined) {
  SchedulerStage stage;
  stage.AddJob(64);
  stage.Join(1);
  stage.Join(2);
  for (int strike = 0; strike < kStrikesMax; ++strike) {
    EXPECT_EQ(stage.Status(1), "fine");
    stage.Advance();
    ASSERT_FALSE(stage.Held(1).empty());
    const Lease lease = stage.Held(1)[0];
    stage.Fail(1, lease, "no");
    stage.Finish(2, lease, 0.1);
  }
  EXPECT_THAT(stage.Status(1), testing::StartsWith("quarantined"));
  stage.Send(1);
  stage.Advance();
  EXPECT_TRUE(stage.Held(1).empty());
  EXPECT_FALSE(stage.told[1].notice.empty());
  EXPECT_TRUE(stage.scheduler.TakeFailedJobs().empty());
  EXPECT_FALSE(stage.Held(2).empty());
}

TEST(SchedulerFailure, AWorkerThatReturnsWrongResultsIsQuarantined) {
  SchedulerStage stage;
  stage.AddJob(64);
  stage.Join(1);
  stage.Join(2);
  for (int strike = 0; strike < kStrikesMax; ++strike) {
    stage.Advance();
    const Lease lease = stage.Held(1)[0];
    stage.held[1].erase(lease.id);
    stage.scheduler.RefuseResult(WorkerId{1}, lease.id, lease.unit, "not finite");
    EXPECT_TRUE(stage.scheduler.IsKnown(lease.unit)) << "the unit is open again";
  }
  EXPECT_THAT(stage.Status(1), HasSubstr("not finite"));
  EXPECT_EQ(stage.Status(2), "fine");
}

TEST(SchedulerFailure, StrikesAreForgivenAfterLongGoodService) {
  SchedulerStage stage;
  stage.AddJob(1 << 20);
  stage.Join(1);
  stage.Join(2);
  for (int strike = 0; strike < kStrikesMax + 1; ++strike) {
    stage.Advance();
    const Lease lease = stage.Held(1)[0];
    stage.Fail(1, lease, "no");
    stage.Finish(2, lease, 0.1);
    for (int unit = 0; unit < kForgivenessUnits;) {
      stage.Advance();
      unit += static_cast<int>(stage.Held(1).size());
      stage.FinishAll(1, 0.01);
      stage.FinishAll(2, 0.01);
      ASSERT_FALSE(stage.IsComplete(JobId{1}, 0));
    }
  }
  EXPECT_EQ(stage.Status(1), "fine");
}

}  // namespace
}  // namespace tessera
