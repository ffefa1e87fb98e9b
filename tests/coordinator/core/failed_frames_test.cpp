// Frames of a sequence that no worker can render, and what becomes of the others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "coordinator/core/schedule/policy.h"
#include "tests/coordinator/core/recovery_stage.h"

namespace tessera {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Three workers fail a unit of the frame, one after the other.
void Fail(Process& process, JobId job, uint32_t frame, const std::string& reason = "no") {
  const WorkUnit unit{job, frame, 1, {0, 2}, *process.farm.SceneOf({job, frame})};
  for (uint64_t w = 1; w <= 3; ++w) {
    const WorkerId worker{w};
    JoinWithFormerLease(process.farm, process.now, CallId{++process.calls}, worker, unit);
    process.farm.FailUnit(worker, FormerLease(), unit, reason);
    process.Step();
  }
}

void Finish(Process& process, JobId job, uint32_t frame) {
  process.ReturnAll(job, frame, 0, 4);
  process.WritePictures();
  process.pictures.clear();
}

TEST(FailedFrames, TheOtherFramesOfTheirJobAreRenderedAndTheJobFailsInTheEnd) {
  Disk disk;
  Process process(disk);
  const JobId job = *process.farm.Submit(process.now, ExtendableJob(4, 3));
  Finish(process, job, 0);
  Fail(process, job, 1, "bad texture");
  JobStatus status = process.Status(job);
  EXPECT_FALSE(HasEnded(status.state));
  EXPECT_EQ(status.frames_failed, 1u);
  EXPECT_EQ(status.samples_total, 2 * 64u) << "nothing is left to do of the failed frame";
  Finish(process, job, 2);
  status = process.Status(job);
  EXPECT_EQ(status.state, JobState::kFailed);
  EXPECT_THAT(status.reason, AllOf(HasSubstr("frame 1 failed"), HasSubstr("bad texture")));
  EXPECT_EQ(status.frames_finished, 2u);
  EXPECT_EQ(status.samples_done, status.samples_total);
  EXPECT_TRUE(process.farm.FinishedFile(job, 0));
  EXPECT_TRUE(process.farm.FinishedFile(job, 2));
  const auto frames = process.farm.Frames(job);
  EXPECT_FALSE(frames[0].has_failed);
  EXPECT_TRUE(frames[1].has_failed);
}

TEST(FailedFrames, WhatWasRenderedOfThemIsKeptAsAPicture) {
  Disk disk;
  Process process(disk);
  const JobId job = *process.farm.Submit(process.now, ExtendableJob(4, 2));
  process.Return(job, 0, 0, {0, 4});
  EXPECT_EQ(process.Status(job).samples_done, 16u);
  const WorkUnit unit{job, 0, 1, {0, 2}, *process.farm.SceneOf({job, 0})};
  for (uint64_t w = 1; w <= 3; ++w) {
    JoinWithFormerLease(process.farm, process.now, CallId{++process.calls}, WorkerId{w}, unit);
    process.farm.FailUnit(WorkerId{w}, FormerLease(), unit, "no");
  }
  process.farm.Advance(process.now);
  const FarmOutput output = process.farm.TakeOutput();
  ASSERT_EQ(output.partial_pictures.size(), 1u);
  EXPECT_EQ(output.partial_pictures[0].frame, 0u);
  EXPECT_THAT(output.dropped, testing::Contains(FrameId{job, 0})) << "its sums are of no use";
  EXPECT_EQ(process.Status(job).samples_done, 0u);
  process.farm.PictureWritten(process.now, {job, 0}, {Sha256("partial"), 4});
  process.Step();
  EXPECT_FALSE(process.farm.FinishedFile(job, 0)) << "it is not the frame's picture";
  EXPECT_FALSE(HasEnded(process.Status(job).state));
}

TEST(FailedFrames, NothingOfThemIsRenderedAgainAfterARestart) {
  Disk disk;
  JobId job{};
  {
    Process before(disk);
    job = *before.farm.Submit(before.now, ExtendableJob(4, 3));
    before.Return(job, 1, 0, {0, 4});
    Fail(before, job, 1, "bad texture");
  }
  // Facts in full, then the fewest that lead to the same state.
  for (const bool is_compacted : {false, true}) {
    Process after(disk);
    EXPECT_EQ(after.Status(job).frames_failed, 1u);
    EXPECT_EQ(after.Status(job).samples_total, 2 * 64u);
    EXPECT_EQ(after.Status(job).samples_done, 0u);
    EXPECT_EQ(after.Return(job, 1, 2, {0, 4}), Verdict::kDuplicate);
    disk.facts.clear();
    for (const Fact& fact : after.farm.Snapshot()) disk.facts.push_back(EncodeFact(fact));
    if (!is_compacted) continue;
    Finish(after, job, 0);
    Finish(after, job, 2);
    EXPECT_EQ(after.Status(job).state, JobState::kFailed);
    EXPECT_THAT(after.Status(job).reason, HasSubstr("frame 1 failed: a unit cannot be rendered: "));
  }
}

TEST(FailedFrames, AJobWhoseLastFrameFailedEndsAlsoIfTheCrashCameBeforeItsEnd) {
  Disk disk;
  JobId job{};
  {
    Process before(disk);
    job = *before.farm.Submit(before.now, ExtendableJob(4, 2));
    Finish(before, job, 0);
    Fail(before, job, 1);
    ASSERT_EQ(before.Status(job).state, JobState::kFailed);
  }
  ASSERT_TRUE(std::holds_alternative<JobEnded>(*DecodeFact(disk.facts.back())));
  disk.facts.pop_back();
  Process after(disk);
  EXPECT_EQ(after.Status(job).state, JobState::kFailed);
}

TEST(FailedFrames, AfterThreeTheRestIsGivenUp) {
  Disk disk;
  Process process(disk);
  const JobId job = *process.farm.Submit(process.now, ExtendableJob(4, 20));
  for (uint32_t frame = 0; frame < kFailedFramesMax; ++frame) {
    EXPECT_FALSE(HasEnded(process.Status(job).state));
    Fail(process, job, frame);
  }
  EXPECT_EQ(process.Status(job).state, JobState::kFailed);
  EXPECT_THAT(process.Status(job).reason,
              AllOf(HasSubstr("frame 0 failed"), HasSubstr("2 more frames failed")));
}

TEST(FailedFrames, AFewAmongManyFinishedDoNotEndTheJob) {
  Disk disk;
  Process process(disk);
  const JobId job = *process.farm.Submit(process.now, ExtendableJob(4, 60));
  for (uint32_t frame = 0; frame < 40; ++frame) Finish(process, job, frame);
  for (uint32_t frame = 40; frame < 44; ++frame) Fail(process, job, frame);
  EXPECT_FALSE(HasEnded(process.Status(job).state));
  Fail(process, job, 44);
  EXPECT_EQ(process.Status(job).state, JobState::kFailed);
}

TEST(FailedFrames, TheirJobCannotBeExtended) {
  Disk disk;
  Process process(disk);
  const JobId job = *process.farm.Submit(process.now, ExtendableJob(4, 3));
  Fail(process, job, 1);
  const auto extended = process.farm.Extend(process.now, job, 8);
  ASSERT_FALSE(extended);
  EXPECT_THAT(extended.error().message, HasSubstr("frame 1 of it failed"));
}

}  // namespace
}  // namespace tessera
