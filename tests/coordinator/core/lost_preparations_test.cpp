// Jobs whose frames a worker does not make: it does not finish, does not list them, or is lost.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "coordinator/core/schedule/policy.h"
#include "tests/coordinator/core/preparation_stage.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// Worker 1 does not finish a preparation in time, and worker 2 does. Returns what worker 1 goes on to list.
std::vector<Digest> HeldTooLong(PreparationStage& stage) {
  const auto order = SmallOrder(1);
  const std::vector<Digest> held{PreparationKey(*order)};
  stage.Order(order);
  EXPECT_TRUE(stage.Call(1));
  stage.Pass(kPreparationDurationMax + seconds(10), {1}, held);
  EXPECT_TRUE(stage.Call(2));
  stage.Return(2, Prepared(*order));
  return held;
}

TEST(LostPreparations, AWorkerThatNeverFinishesLosesThePreparationAndALateReportStillCounts) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  const JobId job = stage.Order(order);
  const std::vector<Digest> held{PreparationKey(*order)};
  ASSERT_TRUE(stage.Call(1));
  stage.Pass(kPreparationDurationMax - seconds(10), {1}, held);
  EXPECT_FALSE(stage.Call(2)) << "it may take long";
  stage.Pass(seconds(30), {1}, held);
  EXPECT_EQ(stage.Status(job).state, JobState::kPreparing);
  EXPECT_EQ(stage.Status(job).reason, "w1: did not finish in 120 minutes");
  ASSERT_TRUE(stage.Call(2));
  stage.Return(1, Prepared(*order));
  EXPECT_EQ(stage.Status(job).state, JobState::kWaiting);
}

TEST(LostPreparations, ThreeWorkersThatNeverFinishEndTheJob) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  const JobId job = stage.Order(order);
  for (uint64_t worker = 1; worker <= 3; ++worker) {
    EXPECT_EQ(stage.Status(job).state, JobState::kPreparing);
    ASSERT_TRUE(stage.Call(worker)) << worker;
    stage.Pass(kPreparationDurationMax + seconds(10), {worker}, {PreparationKey(*order)});
  }
  EXPECT_EQ(stage.Status(job).state, JobState::kFailed);
  EXPECT_EQ(stage.Status(job).reason,
            "the scene cannot be prepared: w1, w2, w3: did not finish in 120 minutes");
}

TEST(LostPreparations, AWorkerThatIsOverdueGetsAnotherOnlyIfThereIsNoOtherWorker) {
  PreparationStage stage;
  const std::vector<Digest> held = HeldTooLong(stage);
  const auto second = SmallOrder(2);
  stage.Order(second);
  EXPECT_FALSE(stage.Call(1, held));
  EXPECT_TRUE(stage.Call(2));
  stage.Return(2, NotPrepared(*second, "no"));
  stage.now += seconds(1);
  EXPECT_TRUE(stage.Call(1, held));
}

TEST(LostPreparations, AWorkerThatIsNoLongerOverdueIsLikeAnyOther) {
  PreparationStage stage;
  (void)HeldTooLong(stage);
  const auto second = SmallOrder(2);
  (void)stage.Call(1);
  stage.Order(second);
  EXPECT_TRUE(stage.Call(1)) << "of workers with equal load the first is chosen";
}

TEST(LostPreparations, AJumpOfTheClockIsNotTimeThatAWorkerHasHad) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  const JobId job = stage.Order(order);
  const std::vector<Digest> held{PreparationKey(*order)};
  ASSERT_TRUE(stage.Call(1));
  (void)stage.Call(1, held);
  (void)stage.Call(1, held, 2 * kPreparationDurationMax);
  (void)stage.Call(1, held);
  EXPECT_EQ(stage.Status(job).reason, "");
  EXPECT_FALSE(stage.Call(2));
}

TEST(LostPreparations, WhatAWorkerDoesNotListGoesToAnotherAndDoesNotCountAsAFailure) {
  for (const bool was_listed : {false, true}) {
    PreparationStage stage;
    const auto order = SmallOrder(7);
    (void)stage.Call(1);
    (void)stage.Call(2);
    const JobId job = stage.Order(order);
    ASSERT_TRUE(stage.Call(1));
    if (was_listed) (void)stage.Call(1, {PreparationKey(*order)});
    const Instant patience = was_listed ? kLeaseDuration : kLeaseUnlistedMax;
    stage.Pass(patience - seconds(2), {1, 2});
    EXPECT_FALSE(stage.Call(2)) << was_listed;
    stage.Pass(seconds(3), {1});
    EXPECT_TRUE(stage.Call(2)) << was_listed;
    EXPECT_EQ(stage.Status(job).reason, "");
    stage.Return(1, Prepared(*order));
    EXPECT_EQ(stage.Status(job).state, JobState::kWaiting);
  }
}

TEST(LostPreparations, WhatTheOnlyWorkerDoesNotListIsSentToItAgain) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  const JobId job = stage.Order(order);
  ASSERT_TRUE(stage.Call(1));
  stage.Pass(seconds(60), {1});
  EXPECT_TRUE(stage.Call(1));
  EXPECT_EQ(stage.Status(job).state, JobState::kPreparing);
  EXPECT_EQ(stage.Status(job).reason, "");
}

TEST(LostPreparations, ASceneThatKillsThreeWorkersOneByOneFails) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  const JobId job = stage.Order(order);
  const std::vector<Digest> held{PreparationKey(*order)};
  for (uint64_t worker = 1; worker <= 3; ++worker) {
    ASSERT_TRUE(stage.Call(worker)) << worker;
    (void)stage.Call(worker, held);
    stage.farm.Cut(stage.now, CallId{stage.calls});
    stage.Step();
    stage.Wait(seconds(10));
  }
  stage.Wait(seconds(30));
  EXPECT_EQ(stage.Status(job).state, JobState::kFailed) << stage.Status(job).reason;
  EXPECT_THAT(stage.Status(job).reason, HasSubstr("was lost while it prepared the scene"));
}

TEST(LostPreparations, AMemberWithManyProcessNumbersFailsNoJobThatOthersPrepare) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  const JobId job = stage.Order(order);
  stage.members[100] = MemberId{8};
  ASSERT_TRUE(stage.Call(100));
  for (uint64_t worker = 1; worker <= 5; ++worker) {
    stage.members[worker] = MemberId{7};
    EXPECT_FALSE(stage.Call(worker));
    stage.Return(worker, NotPrepared(*order, "made up"));
  }
  EXPECT_EQ(stage.Status(job).state, JobState::kPreparing);
  stage.Return(100, Prepared(*order));
  EXPECT_EQ(stage.Status(job).state, JobState::kWaiting);
}

TEST(LostPreparations, WhatAMemberHasFailedGoesToAnotherMember) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  stage.members = {{1, MemberId{7}}, {2, MemberId{7}}, {3, MemberId{8}}};
  const JobId job = stage.Order(order);
  ASSERT_TRUE(stage.Call(1));
  EXPECT_FALSE(stage.Call(2));
  EXPECT_FALSE(stage.Call(3));
  stage.Return(1, NotPrepared(*order, "no"));
  EXPECT_FALSE(stage.Call(2));
  EXPECT_TRUE(stage.Call(3));
  stage.Return(3, NotPrepared(*order, "no"));
  EXPECT_TRUE(stage.Call(2)) << "nobody else is left";
  stage.Return(2, NotPrepared(*order, "no"));
  EXPECT_EQ(stage.Status(job).state, JobState::kFailed) << "three workers of all members";
}

TEST(LostPreparations, ThreeWorkersOfOneMemberEndTheJobIfThereAreNoOthers) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  const JobId job = stage.Order(order);
  for (uint64_t worker = 1; worker <= 3; ++worker) {
    EXPECT_EQ(stage.Status(job).state, JobState::kPreparing);
    stage.members[worker] = MemberId{7};
    ASSERT_TRUE(stage.Call(worker)) << worker;
    stage.Return(worker, NotPrepared(*order, "no"));
  }
  EXPECT_EQ(stage.Status(job).state, JobState::kFailed);
}

TEST(LostPreparations, ASceneIsNotBlamedForWorkersThatAreLostTogether) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  const JobId job = stage.Order(order);
  for (int round = 0; round < 4; ++round) {
    const auto a = static_cast<uint64_t>(10 + 2 * round), b = a + 1;
    ASSERT_TRUE(stage.Call(a));
    (void)stage.Call(a, {PreparationKey(*order)});
    const CallId call_of_a{stage.calls};
    (void)stage.Call(b);
    stage.farm.Cut(stage.now, call_of_a);
    stage.farm.Cut(stage.now, CallId{stage.calls});
    stage.Wait(seconds(40));
  }
  EXPECT_EQ(stage.Status(job).state, JobState::kPreparing) << stage.Status(job).reason;
}

}  // namespace
}  // namespace tessera
