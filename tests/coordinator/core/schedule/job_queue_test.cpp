#include "coordinator/core/schedule/job_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "coordinator/core/schedule/policy.h"
#include "tests/coordinator/core/schedule/job_stage.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::Pair;

TEST(JobQueue, RunnableJobsAreOrderedByPriority) {
  JobStage stage;
  JobQueue queue;
  Job &low = stage.Make(1, 4), &high = stage.Make(2, 4, 5), &other = stage.Make(3, 4);
  for (Job* job : {&low, &high, &other}) queue.Add(*job);
  EXPECT_THAT(queue.runnable(), ElementsAre(Pair(5, std::set{high.id}), Pair(0, std::set{low.id, other.id})));
  queue.SetPaused(high, true);
  EXPECT_THAT(queue.runnable(), ElementsAre(Pair(0, std::set{low.id, other.id})));
  queue.SetPriority(high, 7);
  EXPECT_EQ(queue.runnable().size(), 1u) << "still paused";
  queue.SetPaused(high, false);
  EXPECT_EQ(queue.runnable().begin()->first, 7);
  queue.Remove(high);
  EXPECT_EQ(queue.Find(high.id), nullptr);
  EXPECT_EQ(queue.runnable().begin()->first, 0);
}

TEST(JobQueue, KnowsUnitsOfOpenFramesOnly) {
  JobStage stage;
  JobQueue queue;
  Job& job = stage.Make(1, 6);
  const Digest scene = job.SceneOf(0);
  EXPECT_FALSE(queue.IsKnown({job.id, 0, 0, {0, 4}, scene})) << "the job is not open";
  queue.Add(job);
  EXPECT_TRUE(queue.IsKnown({job.id, 0, 3, {0, 4}, scene}));
  EXPECT_FALSE(queue.IsKnown({job.id, 0, 4, {0, 4}, scene})) << "no such tile";
  EXPECT_FALSE(queue.IsKnown({job.id, 1, 0, {0, 4}, scene})) << "no such frame";
  EXPECT_FALSE(queue.IsKnown({job.id, 0, 0, {0, 8}, scene})) << "more samples than the frame has";
  EXPECT_FALSE(queue.IsKnown({job.id, 0, 3, {0, 4}, Sha256("another scene")}));
  EXPECT_EQ(queue.FindFrame({job.id, 0, 0, {0, 4}}), nullptr) << "the frame is not begun";
  EXPECT_NE(queue.FindOrBegin({job.id, 0, 0, {0, 4}}), nullptr);
  EXPECT_NE(queue.FindFrame({job.id, 0, 0, {0, 4}}), nullptr);
}

TEST(JobQueue, UnitsGetShorterAsLessIsLeft) {
  JobStage stage;
  JobQueue queue;
  Job& job = stage.Make(1, 1024);
  queue.Add(job);
  EXPECT_EQ(JobQueue::UnitSeconds(job, 4, 4), kUnitDurationMax_s) << "nothing is measured";
  ActiveFrame& frame = *queue.FindOrBegin({job.id, 0, 0, {0, 1}});
  frame.work.RecordCost({0, {0, 1}}, 0.001);
  const double left_s = *JobQueue::OpenCost(job);
  EXPECT_NEAR(left_s, 4 * 1024 * 0.001, 1e-9);
  EXPECT_DOUBLE_EQ(JobQueue::UnitSeconds(job, 4, 4), left_s / 4 / kGuidedDivisor);
  EXPECT_DOUBLE_EQ(JobQueue::UnitSeconds(job, 4, 4000), kUnitDurationMin_s);
  EXPECT_DOUBLE_EQ(JobQueue::UnitSeconds(job, 15'000, 15'000), 15'000 / kResultsPerSecondBurst)
      << "many slots get longer units";
}

TEST(JobQueue, PackagesAheadSkipJobsWithManyScenes) {
  JobStage stage;
  JobQueue queue;
  Job &first = stage.Make(1, 4, 1), &sequence = stage.Make(2, 4, 0, 3), &second = stage.Make(3, 4);
  for (Job* job : {&first, &sequence, &second}) queue.Add(*job);
  EXPECT_THAT(queue.PackagesAhead(), ElementsAre(first.spec->package, second.spec->package));
}

}  // namespace
}  // namespace tessera
