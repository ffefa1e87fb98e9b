// Jobs whose frames a worker makes.
#include "coordinator/core/preparations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/core/preparation_stage.h"

namespace tessera {
namespace {

using testing::HasSubstr;

TEST(Preparations, AWorkerMakesTheFramesOfAJobThatIsRenderedThen) {
  PreparationStage stage;
  const auto order = SmallOrder(7, 2);
  const JobId job = stage.Order(order);
  EXPECT_EQ(stage.Status(job).state, JobState::kPreparing);
  EXPECT_EQ(stage.farm.PackagesInUse(), std::vector<Digest>{order->scene.package});
  const auto request = stage.Call(1);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->scene, order->scene);
  EXPECT_EQ(request->key, PreparationKey(*order));
  stage.Return(1, Prepared(*order, 2));
  const JobStatus status = stage.Status(job);
  EXPECT_EQ(status.state, JobState::kWaiting);
  EXPECT_EQ(status.frames_total, 2u);
  EXPECT_EQ(status.samples_total, 2u * 64 * 4);
  EXPECT_EQ(stage.farm.Spec(job)->frames[1].scene_file, "s1");
  stage.Return(1, Prepared(*order, 2));
  EXPECT_EQ(stage.Status(job).frames_total, 2u) << "a copy changes nothing";
  (void)stage.Call(1);
  EXPECT_EQ(stage.farm.Submit(stage.now, SmallJob(7), kOwnerAda).value(), job) << "its submission is known";
}

TEST(Preparations, AnOrderSurvivesARestartAndALateReportCounts) {
  PreparationStage before;
  const auto order = SmallOrder(7);
  const JobId job = before.Order(order);
  ASSERT_TRUE(before.Call(1));
  ASSERT_TRUE(before.farm.SetPriority(before.now, job, 5));
  before.Step();
  PreparationStage after;
  for (const bool is_compacted : {false, true}) {
    Farm farm{SchedulerOptions{kLaterEpoch}};
    std::vector<Fact> facts;
    for (const std::string& bytes : before.facts) facts.push_back(*DecodeFact(bytes));
    if (is_compacted) facts = before.farm.Snapshot();
    for (const Fact& fact : facts) farm.Restore(fact);
    farm.Begin(before.now);
    const auto status = farm.Status(before.now, job);
    ASSERT_TRUE(status);
    EXPECT_EQ(status->state, JobState::kPreparing);
    EXPECT_EQ(status->priority, 5);
    EXPECT_EQ(status->owner, kOwnerAda);
    farm.ReturnPreparation(before.now, WorkerId{1}, Prepared(*order));
    farm.Advance(before.now);
    EXPECT_EQ(farm.Status(before.now, job)->state, JobState::kWaiting);
    EXPECT_EQ(farm.Status(before.now, job)->priority, 5) << "it was changed since";
    Farm third{SchedulerOptions{kLaterEpoch}};
    for (const Fact& fact : facts) third.Restore(*DecodeFact(EncodeFact(fact)));
    for (const Fact& fact : farm.TakeOutput().facts) third.Restore(*DecodeFact(EncodeFact(fact)));
    third.Begin(before.now);
    EXPECT_EQ(third.Status(before.now, job)->state, JobState::kWaiting);
    EXPECT_EQ(third.Status(before.now, job)->frames_total, 1u);
  }
}

TEST(Preparations, ThreeWorkersThatFailEndTheJobWithTheirReasons) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  const JobId job = stage.Order(order);
  for (uint64_t worker = 1; worker <= 3; ++worker) {
    ASSERT_TRUE(stage.Call(worker)) << worker;
    stage.Return(worker, NotPrepared(*order, "box.pbrt:3:1: unknown directive"));
    stage.now += milliseconds(500);
    EXPECT_FALSE(stage.Call(worker)) << "a worker does not get what it has failed";
    if (worker == 3) break;
    EXPECT_EQ(stage.Status(job).state, JobState::kPreparing);
    EXPECT_THAT(stage.Status(job).reason, HasSubstr("box.pbrt:3:1"));
  }
  EXPECT_EQ(stage.Status(job).state, JobState::kFailed);
  EXPECT_THAT(stage.Status(job).reason, HasSubstr(": w1, w2, w3: box.pbrt:3:1: unknown directive"));
  EXPECT_EQ(stage.Status(job).frames_total, 0u);
  EXPECT_FALSE(stage.farm.Extend(stage.now, job, 8));
}

TEST(Preparations, OnAFarmOfOneWorkerItsFailureEndsTheJobAfterAWhile) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  const JobId job = stage.Order(order);
  ASSERT_TRUE(stage.Call(1));
  stage.Return(1, NotPrepared(*order, "no"));
  stage.Pass(seconds(30), {1});
  EXPECT_EQ(stage.Status(job).state, JobState::kPreparing) << "another worker may join";
  stage.Pass(seconds(40), {1});
  EXPECT_EQ(stage.Status(job).state, JobState::kFailed);
}

TEST(Preparations, FramesThatWereNotOrderedAreAFailureOfTheWorker) {
  const auto order = SmallOrder(7, 2);
  const auto is_accepted = [&](auto change) {
    PreparationStage stage;
    const JobId job = stage.Order(order);
    (void)stage.Call(1);
    PreparationReport report = Prepared(*order, 2);
    change(report.frames);
    stage.Return(1, report);
    return stage.Status(job).state == JobState::kWaiting;
  };
  using Frames = std::vector<FrameRequest>;
  EXPECT_TRUE(is_accepted([](Frames&) {}));
  EXPECT_FALSE(is_accepted([](Frames& frames) { frames.pop_back(); }));
  EXPECT_FALSE(is_accepted([](Frames& frames) { frames[1].number = 2; }));
  EXPECT_FALSE(is_accepted([](Frames& frames) { frames[1].scene_file = "s0"; }));
  EXPECT_FALSE(is_accepted([](Frames& frames) { frames[1].options = "spp=5\n"; }));
  EXPECT_FALSE(is_accepted([](Frames& frames) { frames[1].options += "seed=1\n"; }));
  EXPECT_FALSE(is_accepted([](Frames& frames) { frames[1].options = ""; }));
}

TEST(Preparations, AWorkerInQuarantineNeitherMakesFramesNorFailsTheScene) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  const JobId job = stage.Order(order);
  Farm farm{SchedulerOptions{kLaterEpoch}};
  for (const std::string& bytes : stage.facts) farm.Restore(*DecodeFact(bytes));
  for (uint64_t worker = 1; worker <= 3; ++worker)
    farm.Restore(WorkerQuarantined{WorkerId{worker}, "w", false, "it disagrees"});
  farm.Begin(stage.now);
  farm.ReturnPreparation(stage.now, WorkerId{1}, Prepared(*order));
  for (uint64_t worker = 1; worker <= 3; ++worker)
    farm.ReturnPreparation(stage.now, WorkerId{worker}, NotPrepared(*order, "no"));
  EXPECT_EQ(farm.Status(stage.now, job)->state, JobState::kPreparing);
  EXPECT_EQ(farm.Status(stage.now, job)->reason, "");
  farm.ReturnPreparation(stage.now, WorkerId{4}, Prepared(*order));
  EXPECT_EQ(farm.Status(stage.now, job)->state, JobState::kWaiting);
}

TEST(Preparations, FramesBeyondTheMemoryForJobsEndTheirJob) {
  PreparationStage stage;
  const auto order = SmallOrder(7, 2500);
  order->scene.options = "light-group=" + std::string(kOptionsBytesMax - 100, 'x') + "\n";
  const JobId job = stage.Order(order);
  ASSERT_TRUE(stage.Call(1));
  PreparationReport report = Prepared(*order, 2500);
  for (FrameRequest& frame : report.frames) frame.options = order->scene.options;
  stage.Return(1, report);
  EXPECT_EQ(stage.Status(job).state, JobState::kFailed);
  EXPECT_THAT(stage.Status(job).reason, HasSubstr("would exceed the limit of 128 MB"));
  EXPECT_TRUE(stage.farm.Order(stage.now, SmallOrder(8), kOwnerAda)) << "it takes no memory";
}

TEST(Preparations, WhatIsCancelledMeanwhileStaysCancelled) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  const JobId job = stage.Order(order);
  ASSERT_TRUE(stage.Call(1));
  ASSERT_TRUE(stage.farm.Cancel(stage.now, job));
  stage.Return(1, Prepared(*order));
  EXPECT_EQ(stage.Status(job).state, JobState::kCancelled);
  stage.now += seconds(1);
  EXPECT_FALSE(stage.Call(2));
  EXPECT_TRUE(stage.farm.PackagesInUse().empty());
}

TEST(Preparations, ARequestThatIsLostIsSentAgainUntilTheWorkerListsIt) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  stage.Order(order);
  ASSERT_TRUE(stage.Call(1));
  EXPECT_FALSE(stage.Call(1, {}, milliseconds(100))) << "the answer may be on its way";
  stage.now += seconds(1);
  EXPECT_TRUE(stage.Call(1));
  stage.now += seconds(1);
  EXPECT_FALSE(stage.Call(1, {PreparationKey(*order)}));
  stage.now += seconds(1);
  EXPECT_FALSE(stage.Call(1, {PreparationKey(*order)}));
}

TEST(Preparations, EachOwnerHasOneAtATimeByPriority) {
  PreparationStage stage;
  const auto first = SmallOrder(1), urgent = SmallOrder(2), of_bob = SmallOrder(3);
  urgent->priority = 9;
  ASSERT_TRUE(stage.farm.Order(stage.now, first, kOwnerAda));
  ASSERT_TRUE(stage.farm.Order(stage.now, urgent, kOwnerAda));
  ASSERT_TRUE(stage.farm.Order(stage.now, of_bob, kOwnerBob));
  EXPECT_EQ(stage.Call(1)->key, PreparationKey(*urgent));
  EXPECT_EQ(stage.Call(2)->key, PreparationKey(*of_bob));
  stage.now += seconds(1);
  EXPECT_FALSE(stage.Call(3)) << "ada has one already";
  stage.Return(1, Prepared(*urgent));
  stage.now += seconds(1);
  EXPECT_EQ(stage.Call(1)->key, PreparationKey(*first));
}

TEST(Preparations, APausedJobWaits) {
  PreparationStage stage;
  const auto order = SmallOrder(7);
  const JobId job = stage.Order(order);
  ASSERT_TRUE(stage.farm.SetPaused(stage.now, job, true));
  EXPECT_EQ(stage.Status(job).state, JobState::kPaused);
  EXPECT_FALSE(stage.Call(1));
  ASSERT_TRUE(stage.farm.SetPaused(stage.now, job, false));
  stage.now += seconds(1);
  EXPECT_TRUE(stage.Call(1));
}

TEST(Preparations, AnOwnerMayHaveALimitedNumberWaiting) {
  PreparationStage stage;
  for (uint64_t i = 1; i <= kOrdersPerOwnerMax; ++i) stage.Order(SmallOrder(i));
  EXPECT_FALSE(stage.farm.Order(stage.now, SmallOrder(1000), kOwnerAda));
  EXPECT_TRUE(stage.farm.Order(stage.now, SmallOrder(1), kOwnerAda)) << "it is there already";
  EXPECT_TRUE(stage.farm.Order(stage.now, SmallOrder(1001), kOwnerBob));
}

}  // namespace
}  // namespace tessera
