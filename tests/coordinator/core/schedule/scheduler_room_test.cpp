// How many frames of all jobs are active at the same time.
#include <gtest/gtest.h>

#include "tests/coordinator/core/schedule/scheduler_stage.h"

namespace tessera {
namespace {

size_t ActiveFramesOf(const SchedulerStage& stage) {
  size_t active = 0;
  for (const auto& [id, job] : stage.jobs) active += job.schedule.active.size();
  return active;
}

size_t IncompleteFramesOf(const SchedulerStage& stage) {
  size_t incomplete = 0;
  for (const auto& [id, job] : stage.jobs)
    incomplete += job.schedule.active.size() + job.schedule.ahead.size();
  return incomplete;
}

// All workers finish what they hold until no frame is left; fails after too many rounds.
void RenderAll(SchedulerStage& stage, uint64_t workers) {
  for (int round = 0; round < 5000 && IncompleteFramesOf(stage) > 0; ++round) {
    stage.Advance(milliseconds(10));
    for (uint64_t w = 1; w <= workers; ++w) {
      stage.FinishAll(w, 0.01);
      stage.Send(w);
    }
    ASSERT_LE(ActiveFramesOf(stage), kActiveStretch * kActiveFramesMax);
  }
  EXPECT_EQ(IncompleteFramesOf(stage), 0u);
}

// Jobs with one frame of more tiles than may be active.
JobId AddJobOfManyTiles(SchedulerStage& stage, uint64_t id) {
  auto spec = std::make_shared<JobSpec>();
  spec->submission = id;
  spec->package = Sha256(std::to_string(id));
  FrameSpec frame;
  frame.width = frame.height = 1025;
  frame.crop = {0, 0, 1025, 1025};
  frame.tile_size = 1;
  frame.samples_per_pixel = 1;
  spec->frames = {{"a", "", frame, 0}, {"b", "", frame, 1}};
  stage.specs[JobId{id}] = spec;
  stage.Open(JobId{id}, spec);
  return JobId{id};
}

// A job of two frames of 4 GiB, of which two reach all limits.
JobId AddJobOfLargeFrames(SchedulerStage& stage, uint64_t id, int priority) {
  auto spec = std::make_shared<JobSpec>();
  spec->submission = id;
  spec->priority = priority;
  spec->package = Sha256(std::to_string(id));
  FrameSpec frame;
  frame.width = frame.height = 16'384;
  frame.crop = {0, 0, frame.width, frame.height};
  frame.tile_size = 1024;
  frame.samples_per_pixel = 1;
  spec->frames = {{"a", "", frame, 0}, {"b", "", frame, 1}};
  stage.specs[JobId{id}] = spec;
  stage.Open(JobId{id}, spec);
  return JobId{id};
}

TEST(SchedulerRoom, AJoinBeginsFramesOfTheOldestJobsUpToTheLimit) {
  SchedulerStage stage;
  for (int j = 0; j < 600; ++j) stage.AddJob(1, 0, 2);
  stage.Join(1);
  stage.Advance();
  EXPECT_EQ(ActiveFramesOf(stage), kActiveFramesMax);
  EXPECT_EQ(stage.jobs.at(JobId{1}).schedule.active.size(), 2u);
  EXPECT_EQ(stage.jobs.at(JobId{600}).schedule.active.size(), 0u);
}

TEST(SchedulerRoom, FramesOfManyTilesAreBegunOneByOne) {
  SchedulerStage stage;
  for (uint64_t id = 1; id <= 3; ++id) AddJobOfManyTiles(stage, id);
  stage.Join(1);
  stage.Advance();
  EXPECT_EQ(stage.jobs.at(JobId{1}).schedule.active.size(), 2u) << "the most urgent job has one in reserve";
  EXPECT_EQ(ActiveFramesOf(stage), 2u);
  EXPECT_GT(stage.Held(1).size(), 0u);
}

TEST(SchedulerRoom, AllFramesBeyondTheLimitAreRenderedInTheEnd) {
  SchedulerStage stage;
  for (int j = 0; j < 300; ++j) stage.AddJob(1, 0, 2);
  for (uint64_t w = 1; w <= 4; ++w) stage.Join(w, 16);
  RenderAll(stage, 4);
}

TEST(SchedulerRoom, AnUrgentJobIsBegunWhileOthersFillTheLimit) {
  SchedulerStage stage;
  for (int j = 0; j < 300; ++j) stage.AddJob(1, 0, 2);
  stage.Join(1);
  stage.Advance();
  const JobId urgent = stage.AddJob(1, 5, 4);
  stage.Join(2);
  stage.Advance();
  EXPECT_GT(stage.HeldOf(urgent), 0u);
  EXPECT_EQ(stage.jobs.at(urgent).schedule.active.size(), 2u);
}

TEST(SchedulerRoom, FramesOfPausedJobsDoNotHoldUpOthers) {
  SchedulerStage stage;
  for (int j = 0; j < 300; ++j) stage.AddJob(1, 0, 2);
  stage.Join(1);
  stage.Advance();
  for (auto& [id, job] : stage.jobs) {
    if (!job.schedule.active.empty()) stage.SetPaused(id, true);
  }
  stage.FinishAll(1, 0.01);
  stage.Send(1);
  stage.Advance();
  EXPECT_GT(stage.Held(1).size(), 0u);
}

TEST(SchedulerRoom, AWorkerThatLoadsNoSceneHasOneFrameBegunBeyondAllLimits) {
  SchedulerStage stage;
  for (uint64_t id = 1; id <= 6; ++id) AddJobOfLargeFrames(stage, id, static_cast<int>(id));
  stage.Join(2);  // of the most urgent job, so that its frames are in use
  stage.Worker(1);
  for (int round = 0; round < 30; ++round) {
    stage.Send(1);
    stage.Send(2);
    stage.Advance(milliseconds(100));
    for (const SceneRequest& scene : stage.told[1].scenes)
      stage.scheduler.FailScene(WorkerId{1}, scene.key, "too large", FailureCause::kWorkerLimit);
  }
  EXPECT_EQ(ActiveFramesOf(stage), 3u);
  EXPECT_FALSE(stage.Held(2).empty());
}

TEST(SchedulerRoom, NoFrameIsBegunBeyondAllLimitsForAWorkerThatMayHelpWithThoseBegun) {
  SchedulerStage stage;
  for (uint64_t id = 1; id <= 3; ++id) AddJobOfLargeFrames(stage, id, 0);
  stage.Join(1, 1000);
  stage.Advance();
  while (stage.scheduler.HasNews(WorkerId{1})) stage.Deliver(1);
  stage.Join(2);
  stage.Advance();
  EXPECT_TRUE(stage.Held(2).empty()) << "all tiles of two frames are leased";
  EXPECT_EQ(ActiveFramesOf(stage), 2u);
  stage.FinishAll(1, 0.01);
  stage.Advance();
  EXPECT_GT(stage.HeldOf(JobId{2}), 0u);
  EXPECT_EQ(ActiveFramesOf(stage), 2u);
}

TEST(SchedulerRoom, AFrameIsBegunBeyondAllLimitsIfThoseBegunArePaused) {
  SchedulerStage stage;
  for (uint64_t id = 1; id <= 3; ++id) AddJobOfLargeFrames(stage, id, 0);
  stage.Join(1);
  stage.Advance();
  stage.SetPaused(JobId{1}, true);
  stage.FinishAll(1, 0.01);
  stage.Send(1);
  stage.Advance();
  EXPECT_EQ(stage.HeldOf(JobId{2}), stage.Held(1).size());
  EXPECT_EQ(ActiveFramesOf(stage), 3u);
}

TEST(SchedulerRoom, WorkersThatFindNoOpenUnitHaveMoreFramesBegun) {
  SchedulerStage stage;
  for (int j = 0; j < 300; ++j) stage.AddJob(1, 0, 2);
  stage.Join(1, 3000);
  stage.Advance();
  while (stage.scheduler.HasNews(WorkerId{1})) stage.Deliver(1);  // more than one answer holds
  EXPECT_EQ(stage.Held(1).size(), 6000u) << "two for each slot, of more frames than the limit";
}

}  // namespace
}  // namespace tessera
