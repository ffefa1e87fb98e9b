// Answers to workers stay far below the message limit, whatever the workers and jobs are like.
#include <gtest/gtest.h>

#include <algorithm>

#include "coordinator/answer_limit.h"
#include "proto/jobs.pb.h"
#include "proto/wire/convert.h"
#include "proto/work.pb.h"
#include "tests/coordinator/core/schedule/scheduler_stage.h"

namespace tessera {
namespace {

// Takes answers until there is no news; returns the largest, encoded.
size_t LargestAnswer(SchedulerStage& stage, size_t leases_expected) {
  size_t largest = 0, leases = 0;
  while (stage.scheduler.HasNews(WorkerId{1})) {
    EXPECT_TRUE(stage.scheduler.news().contains(WorkerId{1})) << "a call that waits is answered";
    const WorkerDirective directive = stage.scheduler.TakeDirective(stage.now, WorkerId{1});
    if (directive.leases.empty()) break;
    proto::WorkerDirective message;
    Write(directive, message);
    largest = std::max(largest, message.ByteSizeLong());
    leases += directive.leases.size();
  }
  EXPECT_EQ(leases, leases_expected);
  return largest;
}

constexpr size_t kAnswerBytesMax = size_t{512} << 10;

TEST(AnswerSize, IsBoundedForAWorkerOfVeryManySlots) {
  SchedulerStage stage;
  stage.AddJob(1 << 16, 0, 16);
  stage.Join(1, kSlotsMax);
  stage.scheduler.Advance(stage.now);
  const size_t leases = stage.scheduler.lease_count();
  ASSERT_GT(leases * kLeaseBytes, kGrantBytesMax);
  const size_t largest = LargestAnswer(stage, leases);
  EXPECT_LE(largest, kAnswerBytesMax);
  EXPECT_GT(largest, kGrantBytesMax / 3) << "answers are not smaller than they need to be";
}

// Each lease names its pixels by a mask of 8 KB.
TEST(AnswerSize, IsBoundedForTilesWithPixelMasks) {
  SchedulerStage stage;
  FrameSpec frame;
  frame.width = frame.height = 8192;
  frame.crop = {0, 0, 8192, 8192};
  frame.tile_size = 256;
  frame.samples_per_pixel = 256;
  frame.SetNoiseThreshold(0.01);
  auto spec = std::make_shared<JobSpec>();
  spec->submission = 1;
  spec->frames.push_back({"scene", "", frame, 0});
  stage.specs[JobId{1}] = spec;
  stage.Open(JobId{1}, spec);
  stage.Join(1, 1);
  stage.scheduler.Advance(stage.now);  // the frame is active
  Job& job = stage.jobs.at(JobId{1});
  std::vector<bool> chosen(256 * 256);
  for (size_t pixel = 1; pixel < chosen.size(); pixel += 2) chosen[pixel] = true;
  const PixelMask odd = PixelMask::Of(chosen);
  for (uint32_t tile = 0; tile < 1024; ++tile) stage.scheduler.SetGoal(job, 0, tile, {256, false, odd});
  stage.states[1].slots = 256;
  stage.Send(1);
  stage.scheduler.Advance(stage.now);
  const size_t leases = stage.scheduler.lease_count();
  ASSERT_GT(leases * 8192, 2 * kGrantBytesMax);
  EXPECT_LE(LargestAnswer(stage, leases), kAnswerBytesMax);
}

TEST(AnswerSize, AListKeepsItsLastElementsIfNotAllFit) {
  proto::ListAnswer answer;
  for (uint64_t job = 1; job <= 10'000; ++job) {
    proto::JobStatus& status = *answer.add_jobs();
    status.set_job(job);
    status.set_reason(std::string(kReasonBytesMax, 'x'));
  }
  const uint64_t left_out = KeepLast(*answer.mutable_jobs());
  EXPECT_GT(left_out, 0u);
  EXPECT_EQ(left_out + static_cast<uint64_t>(answer.jobs_size()), 10'000u);
  EXPECT_LE(answer.ByteSizeLong(), kListBytesMax);
  EXPECT_GT(answer.ByteSizeLong(), kListBytesMax - (64 << 10));
  EXPECT_EQ(answer.jobs().rbegin()->job(), 10'000u) << "the newest job";
  EXPECT_EQ(KeepLast(*answer.mutable_jobs()), 0u);
}

}  // namespace
}  // namespace tessera
