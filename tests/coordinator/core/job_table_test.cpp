#include "coordinator/core/job_table.h"

#include <gtest/gtest.h>

#include "coordinator/core/schedule/policy.h"
#include "tests/coordinator/core/farm_stage.h"

namespace tessera {
namespace {

TEST(JobTable, FindsJobsByIdAndSubmission) {
  JobTable jobs;
  const Job& job = jobs.Add(jobs.next_id(), SmallJob(42));
  EXPECT_EQ(jobs.Find(job.id), &job);
  EXPECT_EQ(jobs.FindSubmission(42), &job);
  EXPECT_EQ(jobs.FindSubmission(43), nullptr);
  EXPECT_EQ(jobs.FindOpen(JobId{9}, "paused").error().message,
            "there is no job 9; \"tessera jobs\" lists all jobs");
}

TEST(JobTable, AnEndedJobCannotBeChangedAndSaysSo) {
  JobTable jobs;
  Job& job = jobs.Add(JobId{3}, SmallJob(1));
  EXPECT_EQ(*jobs.FindOpen(job.id, "paused"), &job);
  job.state = JobState::kCancelled;
  jobs.MarkEnded(job.id);
  EXPECT_TRUE(jobs.open().empty());
  EXPECT_EQ(jobs.FindOpen(job.id, "paused").error().message,
            "job 3 is cancelled; it can no longer be paused");
}

TEST(JobTable, IdsAreNeverGivenTwice) {
  JobTable jobs;
  jobs.Add(JobId{7}, SmallJob(1));
  EXPECT_EQ(jobs.next_id(), JobId{8});
  jobs.Remove(JobId{7});
  EXPECT_EQ(jobs.FindSubmission(1), nullptr);
  EXPECT_EQ(jobs.next_id(), JobId{8});
  jobs.ReserveIds(JobId{20});
  jobs.ReserveIds(JobId{10});
  EXPECT_EQ(jobs.next_id(), JobId{21});
}

TEST(JobTable, CountsTheMemoryOfSpecifications) {
  JobTable jobs;
  jobs.Add(JobId{1}, SmallJob(1, 10));
  const uint64_t one = jobs.spec_bytes();
  EXPECT_GT(one, 10 * sizeof(FrameRequest));
  jobs.Add(JobId{2}, SmallJob(2, 10));
  EXPECT_EQ(jobs.spec_bytes(), 2 * one);
  jobs.MarkEnded(JobId{1});
  EXPECT_EQ(jobs.OpenSpecBytes(), one);
  EXPECT_EQ(jobs.spec_bytes(), 2 * one);
  jobs.Remove(JobId{1});
  EXPECT_EQ(jobs.spec_bytes(), one);
}

// A job whose specification takes a quarter of what is allowed.
std::shared_ptr<JobSpec> LargeJob(uint64_t submission) {
  auto spec = SmallJob(submission);
  spec->frames[0].options = std::string(kSpecBytesMax / 4, 'x');
  return spec;
}

TEST(Farm, SpecificationsOfOpenJobsTakeABoundedAmountOfMemory) {
  FarmStage stage;
  for (uint64_t i = 1; i <= 3; ++i) ASSERT_TRUE(stage.farm.Submit(stage.now, LargeJob(i)));
  const auto refused = stage.farm.Submit(stage.now, LargeJob(4));
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("wait for a job to end"), std::string::npos);
  ASSERT_TRUE(stage.farm.Submit(stage.now, SmallJob(5)));
  // Ended jobs make way, the oldest first.
  ASSERT_TRUE(stage.farm.Cancel(stage.now, JobId{1}));
  ASSERT_TRUE(stage.farm.Cancel(stage.now, JobId{2}));
  ASSERT_TRUE(stage.farm.Submit(stage.now, LargeJob(6)));
  stage.Step();
  EXPECT_FALSE(stage.farm.Status(stage.now, JobId{1}));
  EXPECT_TRUE(stage.farm.Status(stage.now, JobId{2}));
}

}  // namespace
}  // namespace tessera
