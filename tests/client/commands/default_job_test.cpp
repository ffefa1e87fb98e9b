#include "client/commands/default_job.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::HasSubstr;

constexpr MemberId kAda{1}, kBob{2};

JobStatus JobOf(uint64_t id, MemberId owner, JobState state) {
  JobStatus job;
  job.job = JobId{id};
  job.name = fmt::format("film-{}", id);
  job.owner = {owner, "somebody"};
  job.state = state;
  return job;
}

TEST(DefaultJob, IsTheOnlyOpenOneOfItsOwner) {
  const std::vector<JobStatus> jobs{JobOf(1, kAda, JobState::kFinished), JobOf(2, kAda, JobState::kPaused),
                                    JobOf(3, kAda, JobState::kCancelled), JobOf(4, kBob, JobState::kRunning),
                                    JobOf(5, MemberId{}, JobState::kWaiting)};
  EXPECT_EQ(*DefaultJob(jobs, kAda), JobId{2});
  EXPECT_EQ(*DefaultJob(jobs, kBob), JobId{4});
  EXPECT_EQ(*DefaultJob(jobs, MemberId{}), JobId{5}) << "submitted on the machine of the coordinator";
}

TEST(DefaultJob, IsTheLastOneIfAllHaveEnded) {
  const std::vector<JobStatus> jobs{JobOf(1, kAda, JobState::kFinished), JobOf(2, kAda, JobState::kFailed),
                                    JobOf(3, kBob, JobState::kFinished)};
  EXPECT_EQ(*DefaultJob(jobs, kAda), JobId{2});
}

TEST(DefaultJob, IsNoneIfSeveralAreOpenWhichAreListed) {
  std::vector<JobStatus> jobs{JobOf(1, kAda, JobState::kRunning), JobOf(2, kBob, JobState::kRunning),
                              JobOf(3, kAda, JobState::kPaused)};
  const auto job = DefaultJob(jobs, kAda);
  ASSERT_FALSE(job);
  EXPECT_EQ(job.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(job.error().message,
              HasSubstr("2 of your jobs are open: 1 \"film-1\" (running), 3 \"film-3\" (paused)"));
  for (uint64_t id = 4; id < 1000; ++id) jobs.push_back(JobOf(id, kAda, JobState::kWaiting));
  const auto many = DefaultJob(jobs, kAda);
  ASSERT_FALSE(many);
  EXPECT_THAT(many.error().message, HasSubstr("9 \"film-9\" (waiting) and 990 more"));
}

TEST(DefaultJob, IsNoneOfSomebodyElse) {
  const auto job = DefaultJob({JobOf(1, kBob, JobState::kRunning)}, kAda);
  ASSERT_FALSE(job);
  EXPECT_EQ(job.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(job.error().message, HasSubstr("no job of this farm is yours"));
  EXPECT_FALSE(DefaultJob({}, kAda));
}

}  // namespace
}  // namespace tessera
