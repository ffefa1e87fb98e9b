// Which job a worker works for.
#include <gtest/gtest.h>

#include "tests/coordinator/core/schedule/scheduler_stage.h"

namespace tessera {
namespace {

TEST(SchedulerJobs, HigherPriorityGoesFirst) {
  SchedulerStage stage;
  stage.AddJob(64, 1);
  const JobId urgent = stage.AddJob(64, 2);
  stage.AddJob(64, 0);
  stage.Join(1, 4);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(urgent), 8u);
}

TEST(SchedulerJobs, LowerPrioritiesGetTheSlotsThatAreLeft) {
  SchedulerStage stage;
  const JobId urgent = stage.AddJob(1, 2);  // 16 units in all
  const JobId other = stage.AddJob(64, 1);
  stage.Join(1, 12);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(urgent), 16u);
  EXPECT_EQ(stage.HeldOf(other), 8u);
}

TEST(SchedulerJobs, EqualJobsShareTheFarm) {
  SchedulerStage stage;
  const JobId jobs[] = {stage.AddJob(64), stage.AddJob(64), stage.AddJob(64)};
  for (uint64_t w = 1; w <= 6; ++w) stage.Join(w, 3);
  stage.Advance();
  for (const JobId job : jobs) EXPECT_EQ(stage.HeldOf(job), 12u);
}

TEST(SchedulerJobs, AFrameThatEndsMakesRoomForTheNextWhileAllWorkersAreIdle) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(1, 0, static_cast<int>(kFramesActiveMax) + 1);
  stage.Join(1, 1000);
  stage.Advance();
  ASSERT_EQ(stage.Held(1).size(), 16u * kFramesActiveMax) << "the last frame has to wait";
  for (const Lease& lease : stage.Held(1)) {
    if (lease.unit.frame == 3) stage.Finish(1, lease, 0.1);
  }
  stage.Advance();
  size_t of_the_last = 0;
  for (const Lease& lease : stage.Held(1)) of_the_last += lease.unit.frame == kFramesActiveMax;
  EXPECT_EQ(of_the_last, 16u);
  EXPECT_TRUE(stage.IsComplete(job, 3));
}

TEST(SchedulerJobs, AWorkerStaysWithTheSceneItHas) {
  SchedulerStage stage;
  const JobId mine = stage.AddJob(64);
  const JobId other = stage.AddJob(64);
  stage.HaveScene(1, mine);
  stage.HaveScene(2, other);
  stage.Send(1);
  stage.Send(2);
  stage.Advance();
  for (const Lease& lease : stage.Held(1)) EXPECT_EQ(lease.unit.job, mine);
  for (const Lease& lease : stage.Held(2)) EXPECT_EQ(lease.unit.job, other);
  EXPECT_TRUE(stage.told[1].scenes.empty());
}

TEST(SchedulerJobs, AnIdleWorkerGetsASceneToLoad) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64);
  stage.Worker(1);
  stage.Send(1);
  stage.Advance();
  ASSERT_EQ(stage.told[1].scenes.size(), 1u);
  EXPECT_EQ(stage.told[1].scenes[0].key, stage.SceneOf(job));
  EXPECT_TRUE(stage.Held(1).empty()) << "no lease before the scene is ready";
  stage.Worker(1).scenes = {{stage.SceneOf(job), false}};
  stage.Send(1);
  stage.Advance();
  EXPECT_TRUE(stage.Held(1).empty());
  stage.Worker(1).scenes[0].ready = true;
  stage.Send(1);
  stage.Advance();
  EXPECT_EQ(stage.Held(1).size(), 2u);
}

TEST(SchedulerJobs, AWorkerLoadsTheSceneOfAJobWithoutWorkersWhileItRendersAnother) {
  SchedulerStage stage;
  const JobId first = stage.AddJob(64);
  stage.Join(1);
  stage.Advance();
  const JobId second = stage.AddJob(64);
  stage.FinishAll(1, 0.1);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(first), 2u);
  ASSERT_EQ(stage.told[1].scenes.size(), 1u);
  EXPECT_EQ(stage.told[1].scenes[0].key, stage.SceneOf(second));
}

TEST(SchedulerJobs, ARemovedJobIsTakenFromItsHolders) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64);
  stage.Join(1, 2);
  stage.Advance();
  const auto leases = stage.Held(1);
  stage.RemoveJob(job);
  stage.Advance();
  EXPECT_EQ(stage.dropped[1].size(), leases.size());
  EXPECT_EQ(stage.scheduler.lease_count(), 0u);
  EXPECT_FALSE(stage.scheduler.IsKnown(leases[0].unit));
}

}  // namespace
}  // namespace tessera
