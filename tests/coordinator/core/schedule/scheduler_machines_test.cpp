// Units that are verified on different machines.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/coordinator/core/schedule/verifying_stage.h"

namespace tessera {
namespace {

// Workers 1 and 2 on one machine, and 3 on another.
struct MachinesStage : VerifyingStage {
  explicit MachinesStage(SchedulerOptions options = {}) : VerifyingStage(1, options) {
    for (const uint64_t w : {1, 2, 3}) Worker(w, 16).machine = w < 3 ? 7 : 8;
  }
  // Rounds of 100 ms in which the workers return results until the job is complete.
  int Rounds(JobId job, std::initializer_list<uint64_t> returning, int rounds_max) {
    int round = 0;
    for (; round < rounds_max && !IsComplete(job, 0); ++round) {
      Advance(milliseconds(100));
      for (const auto& [w, state] : states) {
        if (state.sequence > 0) Send(w);  // it has joined
      }
      for (const uint64_t w : returning) ReturnAll(w, "right");
    }
    return round;
  }
};

TEST(SchedulerMachines, UnitsAreVerifiedOnAnotherMachineIfThereIsOne) {
  MachinesStage stage;
  const JobId job = stage.AddJob(1);
  for (const uint64_t w : {1, 2, 3}) stage.Join(w, 16);
  std::map<WorkUnit, std::set<uint64_t>> machines;
  for (int round = 0; round < 40 && !stage.IsComplete(job, 0); ++round) {
    stage.Advance(milliseconds(100));
    for (const uint64_t w : {1, 2, 3}) {
      for (const WorkUnit& unit : stage.Units(w)) machines[unit].insert(stage.states[w].machine);
      stage.Send(w);
      stage.ReturnAll(w, "right");
    }
  }
  EXPECT_TRUE(stage.IsComplete(job, 0));
  EXPECT_EQ(machines.size(), 16u);
  for (const auto& [unit, numbers] : machines) EXPECT_EQ(numbers.size(), 2u) << unit.Text();
}

TEST(SchedulerMachines, AFarmOfOneMachineVerifiesWithoutDelay) {
  MachinesStage stage;
  const JobId job = stage.AddJob(1);
  for (const uint64_t w : {1, 2}) stage.Join(w, 16);
  EXPECT_LE(stage.Rounds(job, {1, 2}, 100), 2);
}

TEST(SchedulerMachines, AMachineThatMayNotVoteIsNotWaitedFor) {
  MachinesStage stage;
  stage.required_tags = {"big"};
  const JobId job = stage.AddJob(1);
  for (const uint64_t w : {1, 2}) stage.Worker(w).tags = {"big"};
  for (const uint64_t w : {1, 2, 3}) stage.Join(w, 16);
  EXPECT_LE(stage.Rounds(job, {1, 2}, 100), 6) << "the second machine lacks the tag";
}

TEST(SchedulerMachines, AMachineThatReturnsNothingIsWaitedForOnce) {
  MachinesStage stage;
  const JobId job = stage.AddJob(1);
  for (const uint64_t w : {1, 2}) stage.Join(w, 16);
  stage.Send(3);  // it never gets the scene ready
  const int rounds = stage.Rounds(job, {1, 2}, 300);
  EXPECT_GE(rounds, 100) << "10 s";
  EXPECT_LE(rounds, 106);
  EXPECT_TRUE(stage.IsComplete(job, 0));
}

TEST(SchedulerMachines, AnUnaskedResultFromTheSameMachineIsNoSecondVote) {
  MachinesStage stage;
  const JobId job = stage.AddJob(1);
  stage.Join(1, 16);
  stage.Join(3, 16);
  stage.Advance();
  stage.Join(2, 16);
  const Lease lease = stage.Held(1)[0];
  EXPECT_FALSE(stage.Return(1, lease, "wrong"));
  EXPECT_FALSE(stage.Return(2, lease, "wrong"));
  EXPECT_EQ(stage.last.kind, VoteOutcome::Kind::kUseless);
  EXPECT_FALSE(stage.last.vote) << "it is not journalled either";
  for (const Lease& each : stage.Held(3)) {
    if (each.unit == lease.unit) {
      EXPECT_FALSE(stage.Return(3, each, "right"));
    }
  }
  EXPECT_EQ(stage.last.kind, VoteOutcome::Kind::kHeld);
  EXPECT_TRUE(stage.last.is_disputed);
  stage.Worker(4, 16).machine = 9;
  stage.Join(4, 16);
  stage.Advance(milliseconds(100));
  EXPECT_EQ(std::ranges::count(stage.Units(2), lease.unit), 0) << "it could only repeat the first vote";
  ASSERT_EQ(std::ranges::count(stage.Units(4), lease.unit), 1);
  EXPECT_TRUE(stage.Return(4, lease, "right"));
  EXPECT_THAT(stage.Status(1), testing::StartsWith("quarantined"));
  EXPECT_EQ(stage.Status(3), "fine");
  EXPECT_FALSE(stage.IsComplete(job, 0));
}

TEST(SchedulerMachines, ARestartedCoordinatorWaitsForOtherMachinesToReturn) {
  MachinesStage stage(SchedulerOptions{kLaterEpoch});
  const JobId job = stage.AddJob(1);
  for (uint32_t tile = 0; tile < 16; ++tile) {
    stage.scheduler.RestoreVote({job, 0, tile, {0, 1}, stage.SceneOf(job)},
                                {WorkerId{1}, "w1", Sha256("right"), 7});
  }
  stage.Advance();
  stage.Join(2, 16);
  EXPECT_EQ(stage.Rounds(job, {2}, 50), 50) << "the only worker so far runs where the first voter ran";
  stage.Join(3, 16);
  EXPECT_LE(stage.Rounds(job, {3}, 50), 3);
}

TEST(SchedulerMachines, ABackupOfAVerifiedUnitIsOnAThirdMachine) {
  MachinesStage stage;
  const JobId job = stage.AddJob(1);
  stage.Join(1, 16);
  stage.Join(3, 16);
  stage.Advance();
  stage.ReturnAll(3, "right");  // worker 1 is a straggler
  stage.Join(2, 16);
  stage.Worker(4, 16).machine = 9;
  stage.Join(4, 16);
  for (int round = 0; round < 50 && stage.Held(4).empty(); ++round) {
    stage.Advance(milliseconds(100));
    for (const auto& [w, state] : stage.states) stage.Send(w);
  }
  EXPECT_FALSE(stage.Held(4).empty());
  EXPECT_TRUE(stage.Held(2).empty());
  stage.ReturnAll(4, "right");
  EXPECT_TRUE(stage.IsComplete(job, 0));
}

}  // namespace
}  // namespace tessera
