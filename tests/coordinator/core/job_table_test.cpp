#include "coordinator/core/job_table.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace tessera
