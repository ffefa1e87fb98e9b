// Units that two workers render, and workers that are alone with their result.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/core/schedule/verifying_stage.h"

namespace tessera {
namespace {

using Outcome = VoteOutcome::Kind;
using std::chrono::seconds;
using testing::HasSubstr;

TEST(SchedulerVerification, AVerifiedUnitIsGivenToTwoWorkersAndCountsWhenTheyAgree) {
  VerifyingStage stage(1);
  stage.AddJob(1);
  stage.Join(1);
  stage.Join(2);
  stage.Join(3);
  stage.Advance();
  const Lease lease = stage.Held(1)[0];
  const auto second = stage.Units(2);
  ASSERT_NE(std::find(second.begin(), second.end(), lease.unit), second.end());
  EXPECT_EQ(std::ranges::count(stage.Units(3), lease.unit), 0) << "two are enough";
  EXPECT_FALSE(stage.Return(1, lease, "right"));
  EXPECT_EQ(stage.last.kind, Outcome::kHeld);
  for (const Lease& each : stage.Held(2)) {
    if (each.unit == lease.unit) {
      EXPECT_TRUE(stage.Return(2, each, "right"));
    }
  }
  EXPECT_EQ(stage.Status(1), "fine");
  EXPECT_EQ(stage.Status(2), "fine");
}

TEST(SchedulerVerification, AWholeFrameIsVerifiedByTwoWorkers) {
  VerifyingStage stage(1);
  const JobId job = stage.AddJob(8);
  stage.Join(1, 2);
  stage.Join(2, 2);
  for (int round = 0; round < 300 && !stage.IsComplete(job, 0); ++round) {
    stage.Advance();
    stage.ReturnAll(1, "right");
    stage.ReturnAll(2, "right");
  }
  EXPECT_TRUE(stage.IsComplete(job, 0));
}

TEST(SchedulerVerification, AboutTheRequestedShareIsVerifiedAndAlwaysTheSame) {
  const Verification some(0.25, 7), same(0.25, 7), other(0.25, 8), none(0, 7), all(1, 7);
  int chosen = 0, differing = 0;
  for (uint32_t tile = 0; tile < 4000; ++tile) {
    const TileSamples unit{tile, {0, 4}};
    chosen += some.IsChosen(unit);
    differing += some.IsChosen(unit) != other.IsChosen(unit);
    EXPECT_EQ(some.IsChosen(unit), same.IsChosen(unit));
    EXPECT_FALSE(none.IsChosen(unit));
    EXPECT_TRUE(all.IsChosen(unit));
  }
  EXPECT_NEAR(chosen, 1000, 150);
  EXPECT_GT(differing, 1000) << "who does not know the key cannot tell";
}

TEST(SchedulerVerification, AThirdVoteQuarantinesTheWorkerThatIsAlone) {
  VerifyingStage stage(1);
  stage.AddJob(1);
  stage.Join(1);
  stage.Join(2);
  stage.Advance();
  const Lease first = stage.Held(1)[0];
  Lease second;
  for (const Lease& each : stage.Held(2)) {
    if (each.unit == first.unit) second = each;
  }
  EXPECT_FALSE(stage.Return(1, first, "wrong"));
  EXPECT_FALSE(stage.Return(2, second, "right"));
  stage.Join(3, 8);
  stage.Advance();
  for (const Lease& each : stage.Held(3)) {
    if (each.unit == first.unit) {
      EXPECT_TRUE(stage.Return(3, each, "right"));
    }
  }
  EXPECT_THAT(stage.Status(1), HasSubstr("differs from that of two other workers"));
  EXPECT_EQ(stage.Status(2), "fine");
  EXPECT_FALSE(stage.scheduler.IsTrusted(WorkerId{1}));
  EXPECT_EQ(stage.scheduler.TakeDistrusted(), std::vector{WorkerId{1}});
  const auto blocks = stage.scheduler.TakeBlocks();
  ASSERT_EQ(blocks.size(), 1u);
  EXPECT_EQ(blocks[0].worker, WorkerId{1});
}

TEST(SchedulerVerification, IfAllThreeDifferTheJobFails) {
  VerifyingStage stage(1);
  const JobId job = stage.AddJob(1);
  std::optional<WorkUnit> unit;
  for (uint64_t w = 1; w <= 3; ++w) {
    stage.Join(w, 16);
    stage.Advance();
    EXPECT_TRUE(stage.scheduler.TakeFailedJobs().empty());
    if (!unit) unit = stage.Held(w)[0].unit;
    for (const Lease& each : stage.Held(w)) {
      if (each.unit == *unit) stage.Return(w, each, "mine " + std::to_string(w));
    }
  }
  const auto failed = stage.scheduler.TakeFailedJobs();
  ASSERT_EQ(failed.size(), 1u);
  EXPECT_EQ(failed[0].job, job);
  EXPECT_THAT(failed[0].reason, HasSubstr("(w1, w2, w3), so none of them can be trusted"));
}

TEST(SchedulerVerification, AFarmOfTwoCannotDecideADispute) {
  VerifyingStage stage(1, SchedulerOptions{1, 2});
  stage.AddJob(1);
  stage.Join(1, 16);
  stage.Join(2, 16);
  stage.Advance();
  const WorkUnit unit = stage.Held(1)[0].unit;
  for (uint64_t w = 1; w <= 2; ++w) {
    for (const Lease& each : stage.Held(w)) {
      if (each.unit == unit) stage.Return(w, each, std::to_string(w));
    }
  }
  EXPECT_EQ(stage.scheduler.TakeFailedJobs().size(), 1u);
}

TEST(SchedulerVerification, ASingleWorkerRendersEveryUnitOnceAndTheVotesWaitForAnother) {
  VerifyingStage stage(1);
  const JobId job = stage.AddJob(1);
  stage.Join(1, 4);
  for (int round = 0; round < 20; ++round) {
    stage.Advance(seconds(1));
    stage.ReturnAll(1, "right");
    stage.Send(1);
  }
  EXPECT_FALSE(stage.IsComplete(job, 0));
  EXPECT_EQ(stage.HeldOf(job), 0u) << "it is not asked again for what it has said";
  EXPECT_EQ(stage.scheduler.Obstacle(job),
            "16 units wait to be verified by another worker: connect one more");
  stage.Join(2, 16);
  EXPECT_EQ(stage.scheduler.Obstacle(job), "");
  stage.Advance();
  stage.ReturnAll(2, "right");
  EXPECT_TRUE(stage.IsComplete(job, 0));
}

TEST(SchedulerVerification, ASecondResultOfTheSameWorkerIsNoSecondVote) {
  VerifyingStage stage(1);
  stage.AddJob(1);
  stage.Join(1);
  stage.Advance();
  const Lease lease = stage.Held(1)[0];
  EXPECT_FALSE(stage.Return(1, lease, "right"));
  EXPECT_FALSE(stage.Return(1, lease, "right"));
  EXPECT_EQ(stage.last.kind, Outcome::kUseless);
  EXPECT_FALSE(stage.last.vote);
}

TEST(SchedulerVerification, AUnitOfLostWorkersIsCutAnewUntilOneHasRenderedIt) {
  VerifyingStage stage(1);
  const JobId job = stage.AddJob(1);
  stage.Join(1, 16);
  stage.Advance();
  stage.scheduler.Disconnect(stage.now, WorkerId{1});
  stage.held.clear();
  stage.Join(2, 16);
  stage.Join(3, 16);
  stage.Advance();
  stage.ReturnAll(2, "right");
  stage.scheduler.Disconnect(stage.now, WorkerId{2});
  stage.Advance();
  stage.ReturnAll(3, "right");
  EXPECT_TRUE(stage.IsComplete(job, 0)) << "the vote of a worker that is gone stays valid";
}

TEST(SchedulerVerification, OtherVotesOfADistrustedWorkerAreVoid) {
  VerifyingStage stage(1);
  const JobId job = stage.AddJob(1);
  stage.Join(1, 16);
  stage.Advance();
  const WorkUnit disputed = stage.Held(1)[0].unit;
  stage.ReturnAll(1, "wrong");
  for (uint64_t w = 2; w <= 3; ++w) {
    stage.Join(w, 16);
    stage.Advance();
    for (const Lease& each : stage.Held(w)) {
      if (each.unit == disputed) stage.Return(w, each, "right");
    }
  }
  EXPECT_THAT(stage.Status(1), testing::StartsWith("quarantined"));
  for (int round = 0; round < 5; ++round) {
    stage.Advance();
    stage.ReturnAll(2, "right");
    stage.ReturnAll(3, "right");
  }
  EXPECT_TRUE(stage.IsComplete(job, 0));
  EXPECT_EQ(stage.scheduler.TakeDistrusted().size(), 1u);
}

TEST(SchedulerVerification, APartOfAUnitBeingVerifiedIsNotMerged) {
  VerifyingStage stage(1);
  const JobId job = stage.AddJob(8);
  stage.Join(1);
  stage.Advance();
  const Lease lease = stage.Held(1)[0];
  Lease wider = lease;
  wider.id = LeaseId{999};
  wider.unit.range = {0, 8};
  EXPECT_FALSE(stage.Return(2, wider, "sneaked in"));
  EXPECT_EQ(stage.last.kind, Outcome::kUseless);
  EXPECT_FALSE(stage.IsComplete(job, 0));
}

TEST(SchedulerVerification, VotesAreRestored) {
  VerifyingStage stage(1);
  const JobId job = stage.AddJob(1);
  for (uint32_t tile = 0; tile < 16; ++tile) {
    stage.scheduler.RestoreVote({job, 0, tile, {0, 1}, stage.SceneOf(job)},
                                {WorkerId{1}, "w1", Sha256("right")});
  }
  stage.Join(1, 16);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(job), 0u);
  stage.Join(2, 16);
  stage.Advance();
  stage.ReturnAll(2, "right");
  EXPECT_TRUE(stage.IsComplete(job, 0));
}

TEST(SchedulerVerification, AStragglersVerifiedUnitIsBackedUpWhole) {
  VerifyingStage stage(1);
  const JobId job = stage.AddJob(1);
  stage.Join(1, 16);
  stage.Join(2, 16);
  stage.Advance();
  stage.ReturnAll(1, "right");
  stage.Join(3, 16);
  for (int round = 0; round < 100 && stage.Held(3).empty(); ++round) {
    for (const uint64_t w : {1, 2, 3}) stage.Send(w);
    stage.Advance(std::chrono::milliseconds(100));
  }
  ASSERT_GT(stage.HeldOf(job), 0u);
  for (const Lease& each : stage.Held(3)) EXPECT_EQ(each.unit.range, (SampleRange{0, 1}));
  stage.ReturnAll(3, "right");
  EXPECT_EQ(stage.Status(3), "fine");
  EXPECT_TRUE(stage.scheduler.TakeFailedJobs().empty());
}

}  // namespace
}  // namespace tessera
