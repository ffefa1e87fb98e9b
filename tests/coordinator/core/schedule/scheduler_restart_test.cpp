// Workers that end and start again with another process number.
#include <gtest/gtest.h>

#include "tests/coordinator/core/schedule/scheduler_stage.h"

namespace tessera {
namespace {

void Restart(SchedulerStage& stage, uint64_t before, uint64_t after, const std::string& name,
             MemberId member = {}, FarmId farm = {}) {
  stage.scheduler.Disconnect(stage.now, WorkerId{before});
  stage.states.erase(before);
  stage.held.erase(before);
  WorkerState& state = stage.Worker(after);
  state.name = name;
  state.member = member;
  state.farm = farm;
  stage.Join(after);
  stage.Advance();
}

TEST(SchedulerRestart, ADrainOutlivesARestartOfTheWorkerUntilItIsReleased) {
  SchedulerStage stage;
  stage.AddJob(64);
  stage.Join(1);
  stage.scheduler.Drain(WorkerId{1});
  Restart(stage, 1, 2, "w1");
  EXPECT_TRUE(stage.Held(2).empty());
  EXPECT_EQ(stage.told[2].notice, "drained by a user");
  stage.Worker(3).name = "w1";
  stage.Join(3);
  stage.Advance();
  EXPECT_FALSE(stage.Held(3).empty()) << "one worker was drained";
  stage.scheduler.Release(WorkerId{2});
  Restart(stage, 2, 4, "w1");
  EXPECT_FALSE(stage.Held(4).empty());
}

TEST(SchedulerRestart, ADrainOutlivesARestartOfTheWorkerAndOfTheCoordinator) {
  SchedulerStage before;
  before.Join(1);
  before.scheduler.Drain(WorkerId{1});
  Restart(before, 1, 2, "w1");
  SchedulerStage after;
  after.AddJob(64);
  for (const WorkerBlock& block : before.scheduler.TakeBlocks())
    after.scheduler.RestoreBlock(after.now, block);
  Restart(after, 2, 3, "w1", {}, FarmId{1, 1});
  EXPECT_FALSE(after.Held(3).empty()) << "it was a worker of this farm before, and not drained";
  Restart(after, 2, 4, "w1");
  EXPECT_TRUE(after.Held(4).empty());
}

TEST(SchedulerRestart, AQuarantineOutlivesARestartOfAWorkerOfAMember) {
  for (const MemberId member : {MemberId{}, MemberId{7}}) {
    SchedulerStage stage;
    stage.AddJob(64);
    stage.Worker(1).member = member;
    stage.Join(1);
    stage.Join(9);
    for (int strike = 0; strike < kStrikesMax; ++strike) {
      stage.Advance();
      const Lease lease = stage.Held(1)[0];
      stage.held[1].erase(lease.id);
      stage.scheduler.RefuseResult(WorkerId{1}, lease.id, lease.unit, "not finite");
    }
    ASSERT_NE(stage.Status(1), "fine");
    Restart(stage, 1, 2, "w1", member);
    EXPECT_EQ(stage.Status(2) == "fine", member == MemberId{});
    Restart(stage, 9, 3, "w1", MemberId{8});
    EXPECT_EQ(stage.Status(3), "fine") << "another member";
  }
}

TEST(SchedulerRestart, AWorkerThatFallsSilentGivesUpNoMoreTimeThanItsSlotsHad) {
  SchedulerStage stage;
  const JobId job = stage.AddJob(64);
  stage.Join(1, 2);
  stage.Advance();
  ASSERT_EQ(stage.Held(1).size(), 4u) << "two that run and two that wait";
  stage.Send(1);
  for (int s = 0; s < 15; ++s) stage.Advance(milliseconds(1001));
  double given_up_s = 0;
  for (const GivenUpTime& each : stage.scheduler.TakeGivenUp()) {
    EXPECT_EQ(each.job, job);
    given_up_s += each.seconds;
  }
  EXPECT_GT(given_up_s, 2 * Seconds(kWorkerSilenceMax) - 3);
  EXPECT_LT(given_up_s, 2 * Seconds(kWorkerSilenceMax) + 3);
}

}  // namespace
}  // namespace tessera
