// Scenes and units that kill their workers, and workers that are lost for other reasons.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/core/schedule/scheduler_stage.h"

namespace tessera {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Workers join with the scenes of all jobs in memory unless a test says otherwise.
class LossStage : public SchedulerStage {
 public:
  void Die(uint64_t id) {
    scheduler.Disconnect(now, WorkerId{id});
    states.erase(id);
    held.erase(id);
    told.erase(id);
    ++deaths;
  }
  // The connected workers call and the farm decides, for some time.
  void Pass(Instant duration) {
    for (Instant passed{}; passed < duration; passed += milliseconds(500)) {
      const auto live = states;
      for (const auto& [id, state] : live) Send(id);
      Advance(milliseconds(500));
    }
  }
  // Whether the worker is to load the scene of the job.
  bool MustLoad(uint64_t id, JobId job) const {
    const auto found = told.find(id);
    if (found == told.end()) return false;
    return std::ranges::any_of(found->second.scenes,
                               [&](const SceneRequest& each) { return each.key == SceneOf(job); });
  }
  std::vector<FailedJob> Failed() { return scheduler.TakeFailedJobs(); }
  int deaths = 0;
};

TEST(SchedulerLosses, AUnitThatKillsThreeWorkersInARowFailsItsJobByName) {
  LossStage stage;
  const JobId job = stage.AddJob(1);
  std::vector<FailedJob> failed;
  for (uint64_t w = 1; failed.empty(); ++w) {
    ASSERT_LE(w, 3u) << "three deaths are enough";
    stage.Join(w);
    for (int i = 0; i < 20 && stage.Held(w).empty(); ++i) stage.Pass(seconds(1));
    ASSERT_FALSE(stage.Held(w).empty());
    stage.Pass(seconds(1));
    stage.Die(w);
    if (w == 3) stage.Pass(kCrowdWindow + seconds(1));
    failed = stage.Failed();
  }
  EXPECT_EQ(failed[0].job, job);
  EXPECT_THAT(failed[0].reason, AllOf(HasSubstr("kills its workers"), HasSubstr("w1, w2 and w3")));
}

// Each process of the member takes what is suspect if it can, and ends.
TEST(SchedulerLosses, AMemberThatEndsItsProcessesFailsNoJobThatOthersRender) {
  LossStage stage;
  const JobId job = stage.AddJob(1);
  uint64_t next = 1;
  for (int round = 0; round < 300 && !stage.IsComplete(job, 0); ++round) {
    if (stage.deaths == 2 && !stage.states.contains(100)) {
      stage.Worker(100).member = MemberId{8};
      stage.Join(100);
    }
    if (!stage.states.contains(next)) {
      stage.Worker(next).member = MemberId{7};
      stage.Join(next);
    }
    stage.Pass(seconds(1));
    if (!stage.Held(next).empty()) stage.Die(next++);
    stage.FinishAll(100, 0.01);
    ASSERT_TRUE(stage.Failed().empty()) << "after " << stage.deaths << " deaths";
  }
  EXPECT_TRUE(stage.IsComplete(job, 0));
  EXPECT_GT(stage.deaths, 3) << "more than fail a job";
}

TEST(SchedulerLosses, AUnitThatKillsThreeWorkersOfOneMemberFailsItsJobIfThereAreNoOthers) {
  LossStage stage;
  stage.AddJob(1);
  std::vector<FailedJob> failed;
  for (uint64_t w = 1; w <= 3; ++w) {
    EXPECT_TRUE(stage.Failed().empty()) << w;
    stage.Worker(w).member = MemberId{7};
    stage.Join(w);
    for (int i = 0; i < 20 && stage.Held(w).empty(); ++i) stage.Pass(seconds(1));
    ASSERT_FALSE(stage.Held(w).empty());
    stage.Pass(seconds(1));
    stage.Die(w);
  }
  stage.Pass(kCrowdWindow + seconds(1));
  EXPECT_EQ(stage.Failed().size(), 1u);
}

TEST(SchedulerLosses, ASceneThatKillsWorkersAsTheyLoadItFailsItsJobAndSparesTheOthers) {
  LossStage stage;
  const JobId job = stage.AddJob(1);
  uint64_t next = 1;
  for (; next <= 20; ++next) {
    stage.Worker(next);
    stage.Send(next);
  }
  stage.Advance();
  for (uint64_t w = 1; w <= 20; ++w) EXPECT_TRUE(stage.MustLoad(w, job));
  for (uint64_t w = 1; w <= 20; ++w) stage.Die(w);
  std::vector<FailedJob> failed;
  for (int round = 0; round < 200 && failed.empty(); ++round) {
    for (; stage.states.size() < 20; ++next) {
      stage.Worker(next);
      stage.Send(next);
    }
    stage.Pass(seconds(1));
    const auto live = stage.states;
    for (const auto& [id, state] : live) {
      if (stage.MustLoad(id, job)) stage.Die(id);
    }
    failed = stage.Failed();
  }
  ASSERT_FALSE(failed.empty());
  EXPECT_THAT(failed[0].reason, AllOf(HasSubstr("the scene kills its workers"), HasSubstr("loaded")));
  EXPECT_LE(stage.deaths, 20 + 3) << "after the first it is loaded by one worker at a time";
}

TEST(SchedulerLosses, APowerCutThatTakesAllWorkersFailsNoJobHoweverOftenItHappens) {
  LossStage stage;
  stage.AddJob(1 << 16);
  uint64_t next = 1;
  for (int cut = 0; cut < 8; ++cut) {
    for (int i = 0; i < 4; ++i) stage.Join(next++);
    stage.Pass(seconds(8));
    const auto live = stage.states;
    for (const auto& [id, state] : live) stage.Die(id);
    stage.Pass(seconds(60));
    EXPECT_TRUE(stage.Failed().empty()) << "after " << cut + 1 << " cuts";
  }
}

TEST(SchedulerLosses, WorkersThatWereCutOffAndReturnCountAsAlive) {
  LossStage stage;
  const JobId job = stage.AddJob(1);
  for (uint64_t w = 1; w <= 5; ++w) {
    stage.Join(w);
    for (int i = 0; i < 20 && stage.Held(w).empty(); ++i) stage.Pass(seconds(1));
    ASSERT_FALSE(stage.Held(w).empty()) << w;
    const WorkerState state = stage.states[w];
    stage.Die(w);
    stage.Pass(seconds(2));
    stage.Worker(w) = state;
    stage.Send(w);
    WorkerState goodbye = stage.states[w];
    ++goodbye.sequence;
    goodbye.leaving = true;
    stage.scheduler.Synchronize(stage.now, goodbye);
    stage.states.erase(w);
    stage.held.erase(w);
  }
  stage.Pass(seconds(60));
  EXPECT_TRUE(stage.Failed().empty());
  stage.Join(9, 16);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(job), 16u) << "nothing is suspect";
}

TEST(SchedulerLosses, ASuspectIsGivenToOneWorkerAtATimeAndFreeAgainOnceItIsRendered) {
  LossStage stage;
  const JobId job = stage.AddJob(1);
  for (uint64_t w = 1; w <= 2; ++w) {
    stage.Join(w);
    stage.Pass(seconds(2));
    ASSERT_FALSE(stage.Held(w).empty());
    stage.Die(w);
  }
  for (uint64_t w = 3; w <= 6; ++w) stage.Join(w, 4);
  stage.Pass(seconds(10));
  EXPECT_EQ(stage.HeldOf(job), 1u);
  EXPECT_THAT(stage.scheduler.Obstacle(job),
              AllOf(HasSubstr("one worker at a time"), HasSubstr("w1 and w2")));
  for (uint64_t w = 3; w <= 6; ++w) stage.FinishAll(w, 0.01);
  stage.Pass(seconds(10));
  EXPECT_GT(stage.HeldOf(job), 4u);
  EXPECT_TRUE(stage.Failed().empty());
}

TEST(SchedulerLosses, WorkersGoOnWithOtherJobsWhileOneIsTried) {
  LossStage stage;
  const JobId killer = stage.AddJob(1);
  for (uint64_t w = 1; w <= 2; ++w) {
    stage.Join(w);
    stage.Pass(seconds(2));
    stage.Die(w);
  }
  const JobId other = stage.AddJob(64);
  for (uint64_t w = 3; w <= 6; ++w) stage.Join(w);
  stage.Pass(seconds(10));
  EXPECT_LE(stage.HeldOf(killer), 1u);
  EXPECT_GE(stage.HeldOf(other), 3u);
}

TEST(SchedulerLosses, AWorkerThatSaysGoodbyeOrWasDrainedIsNoLoss) {
  LossStage stage;
  stage.AddJob(1);
  for (uint64_t w = 1; w <= 5; ++w) {
    stage.Join(w);
    stage.Pass(seconds(1));
    ASSERT_FALSE(stage.Held(w).empty()) << w;
    stage.scheduler.Drain(WorkerId{w});
    stage.Die(w);
    stage.Pass(seconds(10));
  }
  EXPECT_TRUE(stage.Failed().empty());
}

}  // namespace
}  // namespace tessera
