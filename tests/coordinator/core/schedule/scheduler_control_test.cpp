// What people change while jobs run: pauses and priorities.
#include <gtest/gtest.h>

#include <limits>

#include "tests/coordinator/core/schedule/scheduler_stage.h"

namespace tessera {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(SchedulerControl, APausedJobLosesItsWaitingLeasesAndGetsNoNewOnes) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64);
  stage.Join(1, 2);
  stage.Advance();
  ASSERT_EQ(stage.HeldOf(job), 4u);
  stage.SetPaused(job, true);
  stage.Advance();
  for (int round = 0; round < 50; ++round) {
    stage.Send(1);
    stage.Advance(milliseconds(100));
    EXPECT_EQ(stage.HeldOf(job), 2u) << "those that run may finish, those that waited are gone";
  }
  EXPECT_EQ(stage.dropped[1].size(), 2u);
  for (const Lease& lease : stage.Held(1)) EXPECT_TRUE(stage.Finish(1, lease, 0.1)) << "and are taken";
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(job), 0u);
  stage.Join(2, 2);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(job), 0u);
}

TEST(SchedulerControl, AResumedJobContinuesWhereItWas) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(1);  // 16 units
  stage.Join(1, 4);
  stage.Advance();
  stage.SetPaused(job, true);
  stage.Advance(seconds(1));
  stage.FinishAll(1, 0.1);
  stage.SetPaused(job, false);
  for (int round = 0; round < 8; ++round) {
    stage.Advance(seconds(1));
    stage.FinishAll(1, 0.1);
  }
  EXPECT_TRUE(stage.IsComplete(job, 0));
}

TEST(SchedulerControl, APausedJobLeavesTheFarmToOthers) {
  SchedulerStage stage;
  const JobId urgent = stage.AddJob(64, 5);
  const JobId other = stage.AddJob(64, 1);
  stage.Join(1, 4);
  stage.Advance();
  ASSERT_EQ(stage.HeldOf(other), 0u);
  stage.SetPaused(urgent, true);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(urgent), 4u);
  EXPECT_EQ(stage.HeldOf(other), 4u);
}

TEST(SchedulerControl, ThePausedUnitsOfAWorkerThatGoesReturnToTheirJob) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(1);
  stage.Join(1, 4);
  stage.Advance();
  stage.SetPaused(job, true);
  stage.Advance();
  stage.scheduler.Disconnect(stage.now, WorkerId{1});
  EXPECT_EQ(stage.scheduler.lease_count(), 0u);
  stage.SetPaused(job, false);
  stage.Join(2, 16);
  stage.Advance();
  stage.FinishAll(2, 0.1);
  EXPECT_TRUE(stage.IsComplete(job, 0));
}

TEST(SchedulerControl, ARevokedLeaseIsNotTakenOverWhenALateStateListsIt) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64);
  stage.Join(1, 1);
  stage.Advance();
  ASSERT_EQ(stage.HeldOf(job), 2u);
  stage.SetPaused(job, true);
  stage.Send(1);  // sent before the drop arrived
  EXPECT_EQ(stage.scheduler.lease_count(), 1u);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(job), 1u);
}

TEST(SchedulerControl, ALostLeaseIsNotSentAgainWhileItsJobIsPaused) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64);
  stage.Join(1);
  stage.Advance();
  stage.held[1].clear();  // the answer never arrived
  stage.SetPaused(job, true);
  for (int round = 0; round < 10; ++round) {
    stage.now += milliseconds(200);
    stage.Send(1);
    stage.Advance();
    EXPECT_EQ(stage.HeldOf(job), 0u);
  }
  EXPECT_EQ(stage.scheduler.lease_count(), 0u);
  stage.SetPaused(job, false);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(job), 2u);
}

TEST(SchedulerControl, ARaisedPriorityReplacesWaitingLeasesButNotRunningOnes) {
  SchedulerStage stage;
  const JobId first = stage.AddJob(64, 5);
  const JobId raised = stage.AddJob(64, 1);
  stage.Join(1, 3);
  stage.Advance();
  ASSERT_EQ(stage.HeldOf(first), 6u);
  stage.SetPriority(raised, 9);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(first), 3u);
  EXPECT_EQ(stage.HeldOf(raised), 3u);
  stage.FinishAll(1, 0.1);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(first), 0u);
}

TEST(SchedulerControl, AnUrgentJobTakesNoMorePlacesThanItHasUnits) {
  SchedulerStage stage;
  const JobId first = stage.AddJob(64);
  for (uint64_t w = 1; w <= 10; ++w) stage.Join(w, 3);
  stage.Advance();
  const JobId urgent = stage.AddJob(1, 3);  // 16 units
  for (uint64_t w = 1; w <= 10; ++w) {
    stage.HaveScene(w, urgent);
    stage.Send(w);
  }
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(urgent), 16u);
  EXPECT_EQ(stage.HeldOf(first), 44u);
}

TEST(SchedulerControl, ALoweredPriorityLetsOthersGoFirst) {
  SchedulerStage stage;
  const JobId lowered = stage.AddJob(64, 5);
  const JobId other = stage.AddJob(64, 1);
  stage.Join(1, 2);
  stage.Advance();
  stage.SetPriority(lowered, 0);
  stage.FinishAll(1, 0.1);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(lowered), 0u);
  EXPECT_EQ(stage.HeldOf(other), 4u);
}

TEST(SchedulerControl, APrioritySetDuringAPauseHoldsAfterIt) {
  SchedulerStage stage;
  const JobId paused = stage.AddJob(64, 0);
  const JobId other = stage.AddJob(64, 1);
  stage.SetPaused(paused, true);
  stage.SetPriority(paused, 2);
  stage.Join(1, 2);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(paused), 0u);
  stage.FinishAll(1, 0.1);
  stage.SetPaused(paused, false);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(paused), 4u);
  EXPECT_EQ(stage.HeldOf(other), 0u);
}

TEST(SchedulerControl, AJobGoesOnlyToWorkersThatHaveAllItsTags) {
  SchedulerStage stage;
  stage.required_tags = {"gpu", "linux"};
  const JobId job = stage.AddJob(64);
  stage.Worker(1).tags = {"gpu"};
  stage.Worker(2).tags = {"fast", "gpu", "linux"};
  stage.Worker(3);
  for (uint64_t w = 1; w <= 3; ++w) stage.Send(w);
  stage.Advance();
  EXPECT_TRUE(stage.told[1].scenes.empty());
  EXPECT_EQ(stage.told[2].scenes.size(), 1u);
  EXPECT_TRUE(stage.told[3].scenes.empty());
  for (uint64_t w = 1; w <= 3; ++w) {
    stage.HaveScene(w, job);
    stage.Send(w);
  }
  for (int round = 0; round < 20; ++round) {  // nor in the tail
    stage.Advance(std::chrono::milliseconds(500));
    EXPECT_TRUE(stage.Held(1).empty());
    EXPECT_TRUE(stage.Held(3).empty());
    for (uint64_t w = 1; w <= 3; ++w) stage.Send(w);
  }
  EXPECT_FALSE(stage.Held(2).empty());
}

TEST(SchedulerControl, AJobThatNoWorkerCanRenderShowsWhichTagIsMissing) {
  SchedulerStage stage;
  stage.required_tags = {"gpu"};
  const JobId one = stage.AddJob(64);
  stage.required_tags = {"gpu", "linux"};
  const JobId two = stage.AddJob(64);
  EXPECT_EQ(stage.scheduler.Obstacle(one), "no worker has tag gpu");
  stage.Worker(1).tags = {"gpu"};
  stage.Worker(2).tags = {"linux"};
  stage.Send(1);
  EXPECT_EQ(stage.scheduler.Obstacle(one), "");
  EXPECT_EQ(stage.scheduler.Obstacle(two), "no worker has tag linux");
  stage.Send(2);
  EXPECT_EQ(stage.scheduler.Obstacle(two), "no worker has all of the tags gpu, linux");
  stage.scheduler.Drain(WorkerId{1});
  EXPECT_EQ(stage.scheduler.Obstacle(one), "no worker with tag gpu accepts work: 1 drained");
  EXPECT_EQ(stage.scheduler.Obstacle(two), "no worker has all of the tags gpu, linux");
  stage.scheduler.Disconnect(stage.now, WorkerId{1});
  EXPECT_EQ(stage.scheduler.Obstacle(one), "no connected worker has tag gpu; 1 that had is gone");
}

TEST(SchedulerControl, AnAbsurdSequenceInAWorkersNameDoesNotMuteIt) {
  SchedulerStage stage;
  stage.AddJob(64);
  stage.Join(1);
  WorkerState forged = stage.states[1];
  forged.sequence = std::numeric_limits<uint64_t>::max();
  stage.scheduler.Synchronize(stage.now, forged);
  for (int i = 0; i < 30; ++i) {
    stage.Send(1);
    stage.Advance(seconds(1));
    ASSERT_EQ(stage.Status(1), "fine") << "after " << i << " s it is still connected";
  }
  EXPECT_FALSE(stage.Held(1).empty());
}

TEST(SchedulerControl, AJobShowsWhyNoWorkerWorksAtAll) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64);
  EXPECT_EQ(stage.scheduler.Obstacle(job), "no worker is connected");
  for (uint64_t w = 1; w <= 3; ++w) stage.Join(w);
  EXPECT_EQ(stage.scheduler.Obstacle(job), "");
  stage.scheduler.Drain(WorkerId{1});
  stage.scheduler.Drain(WorkerId{2});
  EXPECT_EQ(stage.scheduler.Obstacle(job), "") << "one is left";
  stage.Worker(3).draining = true;
  stage.Send(3);
  EXPECT_EQ(stage.scheduler.Obstacle(job), "no worker accepts work: 2 drained, 1 about to leave");
  stage.scheduler.Release(WorkerId{2});
  EXPECT_EQ(stage.scheduler.Obstacle(job), "");
}

TEST(SchedulerControl, ADrainedWorkerFinishesWhatItHoldsAndGetsNothingNew) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64);
  stage.Join(1);
  stage.Advance();
  stage.scheduler.Drain(WorkerId{1});
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(job), 2u);
  EXPECT_EQ(stage.told[1].notice, "drained by a user");
  for (const Lease& lease : stage.Held(1)) EXPECT_TRUE(stage.Finish(1, lease, 0.1));
  stage.Send(1);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(job), 0u);
  EXPECT_TRUE(stage.scheduler.Workers(stage.now)[0].draining);
  stage.scheduler.Release(WorkerId{1});
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(job), 2u);
  EXPECT_EQ(stage.told[1].notice, "");
}

TEST(SchedulerControl, AReleasedWorkerHasAllItsStrikesForgiven) {
  SchedulerStage stage;
  stage.AddJob(1 << 10);
  stage.Join(1);
  const auto strike = [&] {
    const Lease lease = stage.Held(1)[0];
    stage.held[1].erase(lease.id);
    stage.scheduler.RefuseResult(WorkerId{1}, lease.id, lease.unit, "not finite");
    stage.Advance();
  };
  stage.Advance();
  for (int strikes = 0; strikes < kStrikesMax; ++strikes) strike();
  EXPECT_NE(stage.Status(1), "fine");
  EXPECT_TRUE(stage.Held(1).empty());
  stage.scheduler.Release(WorkerId{1});
  stage.Advance();
  for (int strikes = 1; strikes < kStrikesMax; ++strikes) strike();
  EXPECT_EQ(stage.Status(1), "fine");
  EXPECT_FALSE(stage.Held(1).empty());
}

TEST(SchedulerControl, ABlockOutlivesAnAbsenceAndARestart) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64);
  stage.Join(1);
  stage.scheduler.Drain(WorkerId{1});
  const auto blocks = stage.scheduler.TakeBlocks();
  ASSERT_EQ(blocks.size(), 1u);
  EXPECT_TRUE(blocks[0].is_drained);
  stage.scheduler.Disconnect(stage.now, WorkerId{1});
  stage.Advance(kWorkerForgotten + seconds(5));
  stage.Send(1);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(job), 0u);

  SchedulerStage after(SchedulerOptions{2});
  after.scheduler.RestoreBlock(after.now, blocks[0]);
  EXPECT_TRUE(after.scheduler.Workers(after.now).empty()) << "it is not there yet";
  const JobId next = after.AddJob(64);
  after.Join(1);
  after.Join(2);
  after.Advance();
  EXPECT_TRUE(after.Held(1).empty());
  EXPECT_EQ(after.HeldOf(next), 2u);
}

// Two jobs whose units differ in length: each holds half of the farm's time, though not half of its leases.
TEST(SchedulerControl, EqualJobsGetEqualTimeHoweverTheyCutTheirUnits) {
  SchedulerStage stage;
  const JobId jobs[] = {stage.AddJob(1 << 20), stage.AddJob(1 << 20)};
  const double seconds_per_sample[] = {0.9, 0.2};  // of the one no unit is shorter
  stage.Join(1, 40);
  double time[2] = {};
  for (int round = 0; round < 40; ++round) {
    stage.Advance();
    for (const Lease& lease : stage.Held(1)) {
      const int of = lease.unit.job == jobs[0] ? 0 : 1;
      const double duration_s = seconds_per_sample[of] * lease.unit.range.size;
      if (round >= 10) time[of] += duration_s;
      stage.Finish(1, lease, duration_s);
    }
    stage.now += seconds(1);
    stage.Send(1);
  }
  EXPECT_NEAR(time[0] / (time[0] + time[1]), 0.5, 0.1);
}

}  // namespace
}  // namespace tessera
