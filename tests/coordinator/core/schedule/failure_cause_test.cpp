// Whose fault a failure is: the scene's, a limit of the worker, or a member's that makes up process numbers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/core/schedule/scheduler_stage.h"

namespace tessera {
namespace {

using std::chrono::seconds;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr const char* kTooLarge = "loading the scene needs more than 16 MiB of memory (--scene-memory)";

class FailureCauses : public testing::Test {
 protected:
  // Connects a worker, which is then asked to load the scene.
  void Meet(uint64_t worker, MemberId member = {}) {
    stage_.Worker(worker).member = member;
    stage_.Send(worker);
    stage_.Advance();
  }
  void Fail(uint64_t worker, FailureCause cause, const std::string& reason) {
    stage_.scheduler.FailScene(WorkerId{worker}, stage_.SceneOf(job_), reason, cause);
  }
  void FailUnit(uint64_t worker, MemberId member) {
    stage_.Worker(worker, 16).member = member;
    stage_.Join(worker, 16);
    stage_.Advance();
    const auto held = stage_.Held(worker);
    const auto poison = std::ranges::find_if(held, [](const Lease& each) { return each.unit.tile == 5; });
    ASSERT_NE(poison, held.end());
    stage_.Fail(worker, *poison, "made up");
  }
  // Lets time pass while these workers stay in contact, and returns the jobs that fail.
  std::vector<FailedJob> Pass(Instant duration, const std::vector<uint64_t>& workers) {
    for (Instant passed{}; passed < duration; passed += seconds(1)) {
      for (const uint64_t each : workers) stage_.Send(each);
      stage_.Advance(seconds(1));
    }
    return stage_.scheduler.TakeFailedJobs();
  }

  SchedulerStage stage_;
  JobId job_ = stage_.AddJob(1 << 20);
};

TEST_F(FailureCauses, WorkersThatAreTooSmallLeaveTheJobToAnotherOneThatLoadsTheScene) {
  Meet(1);
  for (const uint64_t small : {2, 3, 4}) {
    Meet(small);
    Fail(small, FailureCause::kWorkerLimit, kTooLarge);
  }
  EXPECT_THAT(Pass(2 * kPoisonGrace, {1, 2, 3, 4}), IsEmpty());
  EXPECT_EQ(stage_.scheduler.Obstacle(job_), "");
  stage_.HaveScene(1, job_);
  stage_.Send(1);
  for (int round = 0; round < 10; ++round) {
    stage_.Advance();
    ASSERT_THAT(stage_.Held(1), testing::Not(IsEmpty()));
    stage_.FinishAll(1, 0.01);
  }
  for (const uint64_t small : {2, 3, 4}) {
    EXPECT_EQ(stage_.Status(small), "fine") << "a limit is no fault";
    stage_.Send(small);
    EXPECT_FALSE(stage_.scheduler.HasNews(WorkerId{small})) << "it is not asked for the scene again";
  }
}

TEST_F(FailureCauses, AJobThatAllWorkersAreTooSmallForFailsAfterTheGracePeriodWithTheLimit) {
  for (const uint64_t small : {1, 2, 3}) {
    Meet(small);
    Fail(small, FailureCause::kWorkerLimit, kTooLarge);
  }
  EXPECT_THAT(stage_.scheduler.Obstacle(job_), AllOf(HasSubstr("to load the scene"), HasSubstr(kTooLarge)));
  EXPECT_THAT(Pass(kPoisonGrace - seconds(2), {1, 2, 3}), IsEmpty());
  const auto failed = Pass(seconds(4), {1, 2, 3});
  ASSERT_EQ(failed.size(), 1u);
  EXPECT_THAT(failed[0].reason, AllOf(StartsWith("the scene cannot be loaded: w1: "), HasSubstr(kTooLarge)));
}

TEST_F(FailureCauses, TheGracePeriodBeginsWhenTheLastWorkerThatMayLoadTheSceneLeaves) {
  Meet(1);
  Meet(2);
  Fail(2, FailureCause::kWorkerLimit, kTooLarge);
  EXPECT_THAT(Pass(2 * kPoisonGrace, {1, 2}), IsEmpty());
  stage_.scheduler.Disconnect(stage_.now, WorkerId{1});
  stage_.states.erase(1);
  EXPECT_THAT(Pass(kPoisonGrace - seconds(2), {2}), IsEmpty());
  EXPECT_EQ(Pass(seconds(4), {2}).size(), 1u);
}

TEST_F(FailureCauses, AJobWhoseSceneWasRenderedWaitsForAWorkerThatIsLargeEnough) {
  Meet(2);
  Fail(2, FailureCause::kWorkerLimit, kTooLarge);
  stage_.Join(1);
  stage_.Advance();
  stage_.FinishAll(1, 0.01);
  stage_.scheduler.Disconnect(stage_.now, WorkerId{1});
  stage_.held.clear();
  EXPECT_THAT(Pass(3 * kPoisonGrace, {2}), IsEmpty());
  EXPECT_THAT(stage_.scheduler.Obstacle(job_),
              AllOf(HasSubstr("another one is needed"), HasSubstr(kTooLarge)));
  stage_.Send(1);
  stage_.Advance();
  EXPECT_FALSE(stage_.Held(1).empty());
}

TEST(FailureCausesOfASmallFarm, AFarmThatHasNoMoreWorkersDoesNotWaitForAnother) {
  SchedulerStage stage(SchedulerOptions{1, 1});
  const JobId job = stage.AddJob(1);
  stage.Worker(1);
  stage.Send(1);
  stage.Advance();
  stage.scheduler.FailScene(WorkerId{1}, stage.SceneOf(job), kTooLarge, FailureCause::kWorkerLimit);
  stage.Advance(seconds(1));
  EXPECT_EQ(stage.scheduler.TakeFailedJobs().size(), 1u);
}

TEST_F(FailureCauses, ASceneThatWasRenderedIsNotAtFaultWhoeverFailsIt) {
  stage_.Join(1);
  stage_.Advance();
  stage_.FinishAll(1, 0.01);
  for (const uint64_t worker : {2, 3, 4}) {
    Meet(worker);
    Fail(worker, FailureCause::kScene, "made up");
  }
  EXPECT_THAT(Pass(2 * kPoisonGrace, {1, 2, 3, 4}), IsEmpty());
  EXPECT_EQ(stage_.Status(2), "fine");
  for (int again = 1; again < kStrikesMax; ++again) {
    Fail(2, FailureCause::kScene, "made up");
    stage_.Advance();
  }
  EXPECT_THAT(stage_.Status(2), AllOf(StartsWith("quarantined"), HasSubstr("made up")));
}

TEST_F(FailureCauses, AWorkerThatRestartsAfterEachFailureIsQuarantined) {
  stage_.Join(100);
  stage_.Advance();
  stage_.FinishAll(100, 0.01);
  for (uint64_t worker = 1; worker <= kStrikesMax; ++worker) {
    Meet(worker, MemberId{7});
    EXPECT_EQ(stage_.Status(worker), "fine");
    Fail(worker, FailureCause::kScene, "made up");
    if (worker == kStrikesMax) break;
    stage_.scheduler.Disconnect(stage_.now, WorkerId{worker});
    stage_.states.erase(worker);
  }
  EXPECT_THAT(stage_.Status(kStrikesMax), AllOf(StartsWith("quarantined"), HasSubstr("made up")));
  EXPECT_EQ(stage_.Status(100), "fine");
}

TEST_F(FailureCauses, AMemberWithManyProcessNumbersFailsNoSceneByItself) {
  for (const uint64_t honest : {100, 101}) Meet(honest, MemberId{honest});
  for (uint64_t worker = 1; worker <= 5; ++worker) {
    Meet(worker, MemberId{7});
    Fail(worker, FailureCause::kScene, "made up");
  }
  EXPECT_THAT(stage_.scheduler.TakeFailedJobs(), IsEmpty());
  Fail(100, FailureCause::kScene, "a.pbrt:3:1: no such file");
  EXPECT_THAT(stage_.scheduler.TakeFailedJobs(), IsEmpty());
  Fail(101, FailureCause::kScene, "a.pbrt:3:1: no such file");
  EXPECT_EQ(stage_.scheduler.TakeFailedJobs().size(), 1u) << "three members of three";
}

TEST_F(FailureCauses, AMemberWithManyProcessNumbersFailsNoUnitByItself) {
  Meet(100, MemberId{100});
  for (uint64_t worker = 1; worker <= 5; ++worker) FailUnit(worker, MemberId{7});
  EXPECT_THAT(stage_.scheduler.TakeFailedJobs(), IsEmpty());
}

TEST_F(FailureCauses, ThreeWorkersFailAUnitIfAllWorkersAreOfOneMember) {
  for (uint64_t worker = 1; worker <= 3; ++worker) {
    EXPECT_THAT(stage_.scheduler.TakeFailedJobs(), IsEmpty());
    FailUnit(worker, MemberId{7});
  }
  EXPECT_EQ(stage_.scheduler.TakeFailedJobs().size(), 1u);
}

}  // namespace
}  // namespace tessera
